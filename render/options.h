// Settings of the four passes. Every setting that the paper lists is here; the defaults are the
// paper's reference settings (docs/references.md [1]).
#pragma once

#include <string>
#include <vector>

#include "base/options.h"
#include "base/units.h"

namespace wobblebench::render {

/// How a picture is computed: `plain` does each step as the paper writes it and is the yardstick;
/// `fast` makes the same picture (docs/decisions/0014-fast-rendering.md).
enum class PipelineMode { fast, plain };

struct PipelineOptions {
  PipelineMode mode = PipelineMode::fast;
  /// Whether a picture shows frames as they arrive, beside those of the volume before; otherwise
  /// it shows the last complete volume.
  bool mid_volume = false;
};

template <OptionsOf<PipelineOptions> O, class Visitor>
void describe(O& o, Visitor& v) {
  v.choice("mode", o.mode, {{"fast", PipelineMode::fast}, {"plain", PipelineMode::plain}});
  v.flag("mid_volume", o.mid_volume);
}

/// How slices are stored on the GPU. r8 is kept to show what it costs in accuracy: llvmpipe filters
/// it with 8-bit weights.
enum class TextureFormat { r8, r16, r32f };

/// Pass 1: sticks to Cartesian slices, one for each frame.
struct ScanConversionOptions {
  int slice_size = 512;  ///< pixels a side of a slice
  int filter_size = 3;   ///< box filter, odd; 1: none
  TextureFormat format = TextureFormat::r16;
};

template <OptionsOf<ScanConversionOptions> O, class Visitor>
void describe(O& o, Visitor& v) {
  v.integer("slice_size", o.slice_size, 16, 2048);
  v.integer("filter_size", o.filter_size, 1, 15);
  v.choice("format",
           o.format,
           {{"r8", TextureFormat::r8}, {"r16", TextureFormat::r16}, {"r32f", TextureFormat::r32f}});
}

/// Which pictures a cast makes. `surface` ends a ray at the surface, as the paper's reference does.
enum class RenderMode { surface, volume, both };
enum class Projection { parallel, perspective };
/// Which step of brightness along the ray is a surface: fluid to tissue, or tissue to fluid.
enum class EdgeSign { rising, falling };
/// Where the taps of the 3D kernel lie. `slice`: one pixel apart within a slice and one frame apart
/// across slices, so that a slice is filtered once, when its frames have arrived. `ray`: one step
/// apart along the ray and across it, as the paper's pipelining implies.
enum class KernelSpace { slice, ray };

/// The box of interest in the probe frame.
struct VolumeOfInterest {
  glm::dvec3 center_m{0, 0, 0.120};
  glm::dvec3 size_m{0.100, 0.100, 0.080};
};

template <OptionsOf<VolumeOfInterest> O, class Visitor>
void describe(O& o, Visitor& v) {
  v.vec3("center_mm", o.center_m, kMillimetre, -1000, 1000);
  v.vec3("size_mm", o.size_m, kMillimetre, 1, 1000);
}

/// Where the picture is seen from. At rest the viewer looks along +z of the probe frame with x to
/// the right and y down; the eye then turns about the centre of the volume of interest.
struct ViewOptions {
  double yaw_rad = 0;    ///< about the picture's vertical; positive: the eye moves to the right
  double pitch_rad = 0;  ///< about the picture's horizontal; positive: the eye moves up
  double roll_rad = 0;   ///< in the plane of the picture
  Projection projection = Projection::parallel;
  double eye_distance_m = 0.4;  ///< perspective: eye to centre of the volume of interest
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
}

/// Pass 2: rays through the slices.
struct RayCastingOptions {
  RenderMode mode = RenderMode::both;
  int image_size = 512;  ///< pixels a side
  int steps = 512;       ///< samples along the depth of the volume of interest
  int kernel_3d = 3;     ///< 3D Gaussian kernel: 1 (none), 3 or 5 taps a side
  KernelSpace kernel_space = KernelSpace::slice;
  int buffer_length = 8;  ///< n of Eq. (1), even
  /// On Difference of Eq. (1), for samples in [0, 1]. The paper leaves it to the user; this one
  /// suits the boxes of the built-in phantoms, where 8 steps span 0.9 mm, and the kernel in slices
  /// (docs/results/calibration.md).
  double threshold = 0.15;
  EdgeSign edge = EdgeSign::rising;
  int window_2d =
      1;  ///< the buffer takes the mean of this window across the ray; 1: the sample itself
  /// Where between two steps Difference passes the threshold, by linear interpolation; otherwise
  /// the ray length of the first step beyond it, as the paper has it.
  bool refine_crossing = true;
  bool stop_at_box = true;           ///< a ray ends on leaving the volume of interest
  bool stop_on_leaving_cone = true;  ///< a ray ends on leaving the cone of valid data
  double opacity_limit = 0.95;       ///< a ray ends at this accumulated opacity; above 1: never
  /// Transfer function: sample values, and their opacity over one millimetre and grey level, each
  /// linear in between.
  std::vector<double> transfer_values = {0.0, 0.2, 0.5, 1.0};
  std::vector<double> transfer_opacity_per_mm = {0.0, 0.0, 0.25, 0.6};
  std::vector<double> transfer_grey = {0.0, 0.2, 0.6, 1.0};
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
  v.integer("buffer_length", o.buffer_length, 2, 64);
  v.real("threshold", o.threshold, 1, -64, 64);
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

/// Pass 3: Blinn-Phong shading of the z-buffer in image space, Eq. (2), with cast shadows.
struct ShadingOptions {
  int depth_filter_size = 9;  ///< box filter on z, odd; 1: none
  Light light = Light::point;
  /// Where the light is, or where it shines from, seen from the picture's middle: to the left and
  /// above are positive. (0, 0) is the viewer's own direction.
  double light_left_rad = 0;
  double light_up_rad = 25 * kDegree;
  double light_distance_m = 0.15;  ///< point light: from the centre of the volume of interest
  double ambient = 0.15;
  double diffuse = 0.75;
  double specular = 0.2;
  double shininess = 20;
  glm::dvec3 base_rgb{0.96, 0.74, 0.55};  ///< what ambient and diffuse light fall on
  bool shadows = true;
  double shadow_coefficient = 0.6;  ///< a shadowed pixel is multiplied by this
  double shadow_bias_m = 0.8e-3;    ///< how far above the ray the map must be to cast a shadow
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
  v.vec3("base_rgb", o.base_rgb, 1, 0, 1);
  v.flag("shadows", o.shadows);
  v.real("shadow_coefficient", o.shadow_coefficient, 1, 0, 1);
  v.real("shadow_bias_mm", o.shadow_bias_m, kMillimetre, 0, 100);
}

/// box: the paper's homogeneous filter. bilateral and guided keep edges; what they cost and do is
/// in docs/decisions/0016-edge-preserving-filter.md.
enum class SmoothingFilter { box, bilateral, guided };

/// Pass 4: the final image.
struct SmoothingOptions {
  SmoothingFilter filter = SmoothingFilter::box;
  int filter_size = 9;  ///< odd, 1: none; the paper's low filtration is 5, its high 9
  /// Grey-level spread that counts as the same surface: bilateral, the weights' standard deviation
  /// of contrast; guided, the standard deviation in a window at which half of it is kept.
  double range_sigma = 0.1;
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

struct RenderOptions {
  PipelineOptions pipeline;
  ScanConversionOptions scan_conversion;
  VolumeOfInterest volume_of_interest;
  ViewOptions view;
  RayCastingOptions ray_casting;
  ShadingOptions shading;
  SmoothingOptions smoothing;
};

/// Throws InvalidOption, its key led by the section: "ray_casting.kernel_3d = 4: must be odd".
void validate(const RenderOptions& options);

}  // namespace wobblebench::render
