// Settings of the four passes, with every setting of the paper; the defaults are the paper's
// reference settings (docs/references.md [1]).
#pragma once

#include <glm/vec3.hpp>
#include <optional>
#include <string_view>
#include <vector>

#include "base/options.h"
#include "base/units.h"

namespace wobblebench::render {

/// How a picture is computed: `plain` computes each sample, pixel and shadow one by one, as the
/// paper describes, and serves as the reference; `fast` computes the same picture with fewer
/// operations (docs/decisions/0014-fast-rendering.md). What is computed is set by the options
/// below: docs/decisions/0006-defaults-of-the-probe.md lists those whose defaults are not the
/// paper's.
enum class PipelineMode { fast, plain };

/// As a scene names it.
constexpr std::string_view to_string(PipelineMode mode) {
  return mode == PipelineMode::fast ? "fast" : "plain";
}

struct PipelineOptions {
  PipelineMode mode = PipelineMode::fast;
  /// true: a picture shows frames as they arrive, beside those of the previous volume; false: it
  /// shows the last complete volume.
  bool mid_volume = false;

  bool operator==(const PipelineOptions&) const = default;
};

template <OptionsOf<PipelineOptions> O, class Visitor>
void describe(O& o, Visitor& v) {
  v.choice("mode",
           o.mode,
           {{to_string(PipelineMode::fast), PipelineMode::fast},
            {to_string(PipelineMode::plain), PipelineMode::plain}});
  v.flag("mid_volume", o.mid_volume);
}

/// How the volume between sticks is made. `plain`: from the neighbours at equal depth, as the paper
/// does. `aligned`: from the neighbours at equal distance from their surface (shape-based
/// interpolation, docs/decisions/0031-the-surface.md).
enum class Sticks { plain, aligned };

/// Before pass 1: sticks between the sticks of the scan.
struct ReconstructionOptions {
  Sticks sticks = Sticks::plain;
  /// aligned: sticks and frames are added until neighbours lie this near at the far side of the
  /// volume of interest.
  double spacing_m = 1e-3;
  /// aligned, or iso_level auto: a stick's own edge is where its echo is so far up from the level
  /// of fluid to that of tissue (render/reconstruction/echo_levels.h).
  double edge_level = 0.5;
  /// aligned: edges of neighbouring sticks lie on one surface unless its slope exceeds this angle.
  double steepest_rad = 65 * kDegree;
  /// What samples from 0 to 1 stand for, dB; scenes take simulation.dynamic_range_db.
  double display_range_db = 60;

  bool operator==(const ReconstructionOptions&) const = default;
};

template <OptionsOf<ReconstructionOptions> O, class Visitor>
void describe(O& o, Visitor& v) {
  v.choice("sticks", o.sticks, {{"plain", Sticks::plain}, {"aligned", Sticks::aligned}});
  v.real("spacing_mm", o.spacing_m, kMillimetre, 0.1, 100);
  v.real("edge_level", o.edge_level, 1, 0.05, 0.95);
  v.real("steepest_deg", o.steepest_rad, kDegree, 0, 85);
  v.real("display_range_db", o.display_range_db, 1, 10, 200);
}

/// Texel format of slices on the GPU. r8 is there to measure its loss of accuracy: llvmpipe filters
/// it with 8-bit weights.
enum class TextureFormat { r8, r16, r32f };

/// Pass 1: scan conversion of each frame to a Cartesian slice, paper section 3.1.
struct ScanConversionOptions {
  int slice_size = 512;  ///< pixels per side of a slice
  int filter_size = 3;   ///< box filter, pixels, odd; 1: none
  TextureFormat format = TextureFormat::r16;

  bool operator==(const ScanConversionOptions&) const = default;
};

template <OptionsOf<ScanConversionOptions> O, class Visitor>
void describe(O& o, Visitor& v) {
  v.integer("slice_size", o.slice_size, 16, 2048);
  v.integer("filter_size", o.filter_size, 1, 15);
  v.choice("format",
           o.format,
           {{"r8", TextureFormat::r8}, {"r16", TextureFormat::r16}, {"r32f", TextureFormat::r32f}});
}

/// Which pictures pass 2 makes. `surface` ends a ray at the surface, as the paper's reference does.
enum class RenderMode { surface, volume, both };
enum class Projection { parallel, perspective };
/// Sign of Difference, Eq. (1), at a surface: rising from fluid to tissue, falling from tissue to
/// fluid.
enum class EdgeSign { rising, falling };
/// What makes a sample of a ray a surface. `paper`: Difference of Eq. (1) reaches `threshold`.
/// `iso`: the sample passes the level `iso_level` of the way from fluid to tissue, both measured in
/// the volume. `floor`: the mean over the last millimetre exceeds the least such mean of the last
/// 11 mm by `iso_level` of the way from fluid to tissue.
enum class Detector { paper, iso, floor };
/// Grid of the taps of the 3D kernel. `slice`: one pixel apart within a slice and one frame apart
/// across slices, so that a slice is filtered once, when its frames have arrived. `ray`: one step
/// apart along and across the ray, as the paper's pipelining implies.
enum class KernelSpace { slice, ray };

/// The box in which rays begin, in the probe frame.
struct VolumeOfInterest {
  glm::dvec3 center_m{0, 0, 0.120};
  glm::dvec3 size_m{0.100, 0.100, 0.080};

  bool operator==(const VolumeOfInterest&) const = default;
};

template <OptionsOf<VolumeOfInterest> O, class Visitor>
void describe(O& o, Visitor& v) {
  v.vec3("center_mm", o.center_m, kMillimetre, -1000, 1000);
  v.vec3("size_mm", o.size_m, kMillimetre, 1, 1000);
}

/// Orientation and projection of the camera. With all angles 0 it faces +z of the probe frame, with
/// x to the right and y down; it turns about the centre of the volume of interest.
struct ViewOptions {
  double yaw_rad = 0;    ///< about the picture's vertical axis; positive: the eye moves right
  double pitch_rad = 0;  ///< about the picture's horizontal axis; positive: the eye moves up
  double roll_rad = 0;   ///< in the plane of the picture
  Projection projection = Projection::parallel;
  double eye_distance_m = 0.4;  ///< perspective: eye to centre of the volume of interest
  /// The picture mirrored: column c shows what column N - 1 - c shows without it. With all angles 0
  /// its left side is +x of the probe frame instead of -x, where line 0 of each frame lies. The
  /// light stays at the side of the viewer that `light_left_deg` names.
  bool flip = false;

  bool operator==(const ViewOptions&) const = default;
};

template <OptionsOf<ViewOptions> O, class Visitor>
void describe(O& o, Visitor& v) {
  v.real("yaw_deg", o.yaw_rad, kDegree, -180, 180);
  v.real("pitch_deg", o.pitch_rad, kDegree, -180, 180);
  v.real("roll_deg", o.roll_rad, kDegree, -180, 180);
  v.choice("projection",
           o.projection,
           {{"parallel", Projection::parallel}, {"perspective", Projection::perspective}});
  v.real("eye_distance_mm", o.eye_distance_m, kMillimetre, 1, 10000);
  v.flag("flip", o.flip);
}

inline constexpr int kLongestBuffer = 64;  ///< n of Eq. (1)
inline constexpr double kIsoLevel = 0.72;  ///< RayCastingOptions::iso_level, unless it is automatic

/// Pass 2: ray casting, edge detection and alpha blending, paper section 3.2.
struct RayCastingOptions {
  RenderMode mode = RenderMode::both;
  int image_size = 512;  ///< pixels per side of the picture
  int steps = 512;       ///< samples along the depth of the volume of interest
  int kernel_3d = 3;     ///< 3D Gaussian kernel: 1 (none), 3 or 5 taps per side
  KernelSpace kernel_space = KernelSpace::slice;
  Detector detector = Detector::paper;
  /// iso and floor: fraction of the way from the level of fluid to that of tissue
  /// (render/reconstruction/echo_levels.h), one for the volume. nullopt: each stick has its own
  /// level, below_tissue_db below the tissue behind its edge, and its samples are scaled to it
  /// (render/reconstruction/stick_levels.h); the alpha-blended picture is of the scaled samples.
  std::optional<double> iso_level = kIsoLevel;
  /// iso_level auto: decibels where the beam is 2.4 mm wide; fewer in a wider one, and more where
  /// sticks lie over 4 mm apart.
  double below_tissue_db = 6;
  /// The found surface is moved away from the viewer by this length times the tangent of its
  /// incidence to the beam: a beam sees tissue beside its axis before the surface on it. 0: not;
  /// nullopt: kShareOfWidth of the probe's beam width at the surface, in the direction in which
  /// the surface is tilted (hw::BeamWidths).
  std::optional<double> incidence_correction_m = 0;
  /// iso: a ray that enters the cone beyond the level has its surface there, a cap as that of a
  /// clipped iso-surface. Else, and where it begins in the cone beyond the level, it has one only
  /// where it leaves tissue and enters again.
  bool caps = false;
  /// The border of the surface is smoothed by a Gaussian of this standard deviation where the
  /// surface is steep to its sticks (render/passes/outline.h); 0: not.
  double outline_m = 0;
  /// Pieces of the surface of a smaller area across the view are left out
  /// (render/passes/pieces.h); 0: none.
  double smallest_piece_m2 = 0;
  int buffer_length = 8;  ///< n of Eq. (1), even
  /// n as a length along the ray, so that it does not depend on `steps`: the nearest even number of
  /// steps, 2 to 64. 0: buffer_length says it. Not both.
  double buffer_length_m = 0;
  /// Threshold on Difference of Eq. (1), for samples in [0, 1]. The paper leaves it to the user;
  /// this value suits the boxes of the built-in phantoms, where 8 steps span 0.9 mm, and the kernel
  /// in slices.
  double threshold = 0.15;
  /// Likewise on the difference between the means of the buffer's halves, which does not grow with
  /// n: Difference divided by n / 2. 0: `threshold` says it. Not both.
  double threshold_per_sample = 0;
  EdgeSign edge = EdgeSign::rising;
  /// Side of the window across the ray whose mean enters the buffer (paper section 4); odd; 1: the
  /// sample itself.
  int window_2d = 1;
  /// true: z is interpolated linearly to where Difference crosses the threshold between two steps;
  /// false: z is the ray length of the first step beyond it, as in the paper.
  bool refine_crossing = true;
  bool stop_at_box = true;           ///< a ray ends on leaving the volume of interest
  bool stop_on_leaving_cone = true;  ///< a ray ends on leaving the cone of valid data
  double opacity_limit = 0.95;       ///< a ray ends at this accumulated opacity; above 1: never
  /// Transfer function, piecewise linear: sample values, ascending, and for each its opacity over
  /// one millimetre and its grey level.
  std::vector<double> transfer_values = {0.0, 0.2, 0.5, 1.0};
  std::vector<double> transfer_opacity_per_mm = {0.0, 0.0, 0.25, 0.6};
  std::vector<double> transfer_grey = {0.0, 0.2, 0.6, 1.0};

  bool operator==(const RayCastingOptions&) const = default;
};

template <OptionsOf<RayCastingOptions> O, class Visitor>
void describe(O& o, Visitor& v) {
  v.choice("mode",
           o.mode,
           {{"surface", RenderMode::surface},
            {"volume", RenderMode::volume},
            {"both", RenderMode::both}});
  v.integer("image_size", o.image_size, 1, 4096);
  v.integer("steps", o.steps, 1, 4096);
  v.integer("kernel_3d", o.kernel_3d, 1, 5);
  v.choice(
      "kernel_space", o.kernel_space, {{"slice", KernelSpace::slice}, {"ray", KernelSpace::ray}});
  v.choice("detector",
           o.detector,
           {{"paper", Detector::paper}, {"iso", Detector::iso}, {"floor", Detector::floor}});
  v.real_or_auto("iso_level", o.iso_level, 1, 0.05, 1.5);
  v.real("below_tissue_db", o.below_tissue_db, 1, 0.5, 40);
  v.real_or_auto("incidence_correction_mm", o.incidence_correction_m, kMillimetre, 0, 10);
  v.flag("caps", o.caps);
  v.real("outline_mm", o.outline_m, kMillimetre, 0, 10);
  v.real("smallest_piece_mm2", o.smallest_piece_m2, kMillimetre * kMillimetre, 0, 10000);
  v.integer("buffer_length", o.buffer_length, 2, kLongestBuffer);
  v.real("buffer_length_mm", o.buffer_length_m, kMillimetre, 0, 1000);
  v.real("threshold", o.threshold, 1, -64, 64);
  v.real("threshold_per_sample", o.threshold_per_sample, 1, -1, 1);
  v.choice("edge", o.edge, {{"rising", EdgeSign::rising}, {"falling", EdgeSign::falling}});
  v.integer("window_2d", o.window_2d, 1, 11);
  v.flag("refine_crossing", o.refine_crossing);
  v.flag("stop_at_box", o.stop_at_box);
  v.flag("stop_on_leaving_cone", o.stop_on_leaving_cone);
  v.real("opacity_limit", o.opacity_limit, 1, 0, 2);
  v.reals("transfer_values", o.transfer_values, 1, 0, 1);
  v.reals("transfer_opacity_per_mm", o.transfer_opacity_per_mm, 1, 0, 1);
  v.reals("transfer_grey", o.transfer_grey, 1, 0, 1);
}

enum class Light { point, directional };
/// What ambient and diffuse light fall on. `constant`: base_rgb. `rendered`: base_rgb times the
/// pixel of pass 2's alpha-blended picture, as the paper shades "the rendered 2D image".
enum class ShadingBase { constant, rendered };

/// Pass 3: Blinn-Phong shading of the z-buffer in image space, Eq. (2), with cast shadows, paper
/// section 3.3.
struct ShadingOptions {
  int depth_filter_size = 9;  ///< box filter on z, odd; 1: none
  Light light = Light::point;
  /// Direction of the light from the centre of the volume of interest, positive to the left and up;
  /// (0, 0) is the direction of the viewer.
  double light_left_rad = 0;
  double light_up_rad = 40 * kDegree;
  double light_distance_m = 0.15;  ///< point light: from the centre of the volume of interest
  double ambient = 0.02;
  double diffuse = 0.85;
  double specular = 0.1;
  double shininess = 20;
  /// `rendered` needs ray_casting.mode both: without blending there is no picture to shade.
  ShadingBase base = ShadingBase::constant;
  glm::dvec3 base_rgb{0.89, 0.52, 0.3};  ///< albedo for ambient and diffuse light, linear RGB
  bool shadows = true;
  double shadow_coefficient = 0.35;  ///< factor on a shadowed pixel
  double shadow_bias_m = 0.8e-3;     ///< least height of the map above a ray that it occludes

  bool operator==(const ShadingOptions&) const = default;
};

template <OptionsOf<ShadingOptions> O, class Visitor>
void describe(O& o, Visitor& v) {
  v.integer("depth_filter_size", o.depth_filter_size, 1, 15);
  v.choice("light", o.light, {{"point", Light::point}, {"directional", Light::directional}});
  v.real("light_left_deg", o.light_left_rad, kDegree, -89, 89);
  v.real("light_up_deg", o.light_up_rad, kDegree, -89, 89);
  v.real("light_distance_mm", o.light_distance_m, kMillimetre, 1, 10000);
  v.real("ambient", o.ambient, 1, 0, 1);
  v.real("diffuse", o.diffuse, 1, 0, 1);
  v.real("specular", o.specular, 1, 0, 1);
  v.real("shininess", o.shininess, 1, 1, 1000);
  v.choice(
      "base", o.base, {{"constant", ShadingBase::constant}, {"rendered", ShadingBase::rendered}});
  v.vec3("base_rgb", o.base_rgb, 1, 0, 1);
  v.flag("shadows", o.shadows);
  v.real("shadow_coefficient", o.shadow_coefficient, 1, 0, 1);
  v.real("shadow_bias_mm", o.shadow_bias_m, kMillimetre, 0, 100);
}

/// box: the paper's homogeneous filter. bilateral and guided preserve edges
/// (docs/decisions/0016-edge-preserving-filter.md).
enum class SmoothingFilter { box, bilateral, guided };

/// Pass 4: smoothing of the shaded picture, paper section 3.4.
struct SmoothingOptions {
  SmoothingFilter filter = SmoothingFilter::box;
  int filter_size = 9;  ///< pixels, odd, 1: none; the paper's low filtration is 5, its high 9
  /// Contrast that separates noise from edges. bilateral: standard deviation of the range weights;
  /// guided: standard deviation of a window at which half of its contrast is kept.
  double range_sigma = 0.1;

  bool operator==(const SmoothingOptions&) const = default;
};

template <OptionsOf<SmoothingOptions> O, class Visitor>
void describe(O& o, Visitor& v) {
  v.choice("filter",
           o.filter,
           {{"box", SmoothingFilter::box},
            {"bilateral", SmoothingFilter::bilateral},
            {"guided", SmoothingFilter::guided}});
  v.integer("filter_size", o.filter_size, 1, 15);
  v.real("range_sigma", o.range_sigma, 1, 0.001, 10);
}

/// Spatial standard deviation of the bilateral filter, in pixels.
constexpr double bilateral_spatial_sigma(int filter_size) {
  return filter_size / 4.0;
}

/// All settings of a renderer.
///
/// @code
/// render::RenderOptions options;
/// options.volume_of_interest.size_m = {0.08, 0.08, 0.06};
/// options.ray_casting.threshold = 0.2;
/// options.ray_casting.edge = render::EdgeSign::falling;
/// options.smoothing.filter = render::SmoothingFilter::guided;
/// render::validate(options);
/// @endcode
struct RenderOptions {
  PipelineOptions pipeline;
  ReconstructionOptions reconstruction;
  ScanConversionOptions scan_conversion;
  VolumeOfInterest volume_of_interest;
  ViewOptions view;
  RayCastingOptions ray_casting;
  ShadingOptions shading;
  SmoothingOptions smoothing;

  bool operator==(const RenderOptions&) const = default;
};

/// Whether each stick has a level of its own: iso_level is automatic and a detector reads it.
bool has_stick_levels(const RenderOptions& options);

/// Throws InvalidOption with the section in its key: "ray_casting.kernel_3d = 4: must be odd".
void validate(const RenderOptions& options);

}  // namespace wobblebench::render
