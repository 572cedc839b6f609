// The true surface of each pixel of a picture, and the area of it that a pixel shows.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <limits>
#include <span>
#include <vector>

#include "base/image.h"
#include "base/units.h"
#include "hw/probe/acquisition_plan.h"
#include "phantoms/parts.h"
#include "phantoms/placed_phantom.h"
#include "render/camera.h"
#include "render/view.h"

namespace wobblebench::bench {

/// What a ray crosses first in the box of interest. A surface has the first reason that applies
/// why the probe cannot see it (docs/decisions/0028-measures.md).
enum class TruthKind : std::uint8_t {
  none,           ///< nothing
  surface,        ///< a surface that the probe can see
  outside_field,  ///< one that no stick reaches: outside sector, fan or depth
  grazing,        ///< one that its stick meets at more than kGrazing_rad, or from behind
  shadowed,       ///< one behind so much loss that its echo drowns (mark_shadowed())
};

/// Angle of incidence beyond which a surface is no edge to the stick:
/// within one beam width it recedes by more than eleven of them.
inline constexpr double kGrazing_rad = 85 * kDegree;

/// One value per pixel, in the picture's geometry. The fields from `crossing_m` on describe what
/// the ray crosses, whether the probe can see it or not; empty: not known.
///
/// @code
/// #include <cstdio>
///
/// const auto ball = phantoms::still_at(phantoms::make_phantom({.name = "sphere"}), {0, 0, 0.11});
/// const hw::AcquisitionPlan plan({}, {});
/// const bench::Truth truth = bench::trace_truth(ball, plan, render::make_view({}));
/// std::printf("surface %g m from the view plane\n", double{truth.depth_m.at(256, 256)});
/// @endcode
struct Truth {
  Image<float> depth_m;     ///< kNoSurface where kind is not `surface`
  Image<glm::vec3> normal;  ///< unit, out of the tissue, probe frame
  Image<TruthKind> kind;
  Image<float> crossing_m = {};  ///< depth; kNoSurface where kind is `none`
  Image<float> range_m = {};     ///< along the nearest stick
  /// Between the stick and the normal on the side that the edge leads to (EdgeSign), 0 to pi.
  Image<float> incidence_rad = {};
  Image<std::uint8_t> part = {};  ///< label of the part that the ray crosses; 0: none
  std::vector<phantoms::LabelName> parts =
      {};  ///< of a phantom that names its parts: those in the picture
  double cut_by_box_percent = std::numeric_limits<double>::quiet_NaN();  ///< NaN: not known

  /// Depth of what the ray crosses, seen or not; kNoSurface: nothing.
  float any_depth_m(int column, int row) const {
    return crossing_m.pixels.empty() ? depth_m.at(column, row) : crossing_m.at(column, row);
  }
};

/// First crossing, within the view's box, from fluid into tissue (or, for EdgeSign::falling, from
/// tissue into fluid) along the ray of each pixel. Moving tissue is at its position at the time of
/// the stick that images the point (nearest frame and line) in this volume of the plan. Nothing is
/// shadowed yet.
Truth trace_truth(const phantoms::PlacedPhantom& subject,
                  const hw::AcquisitionPlan& plan,
                  const render::View& view,
                  std::uint32_t volume = 0);

/// How much of the surface lies outside the view's box, percent of its area: of what the probe
/// could see in this view, but for the box, to twice the box's size. Of a face the face with ears
/// and crown, whose body always goes on beyond. Truth and picture end at the box alike, so that no
/// error shows it. NaN: the probe sees none.
double cut_by_box_percent(const phantoms::PlacedPhantom& subject,
                          const hw::AcquisitionPlan& plan,
                          const render::View& view,
                          std::uint32_t volume = 0);

/// Those labels of the phantom that occur, by number.
std::vector<phantoms::LabelName> labels_in(std::span<const std::uint8_t> labels,
                                           const phantoms::Phantom& phantom);

/// Whether sticks reach a point: within sector, fan and depth.
bool in_field(const hw::AcquisitionPlan& plan, const hw::PolarPoint& point);

/// Smallest cosine between ray and normal that counts, 88.9 degrees: at the very rim of a body the
/// area of a pixel diverges, and one pixel would outweigh all others. Of a ball 1 % is so left out.
inline constexpr double kLeastCosine = 0.02;

/// dA = t^2 dOmega / |cos|, with t the depth, dOmega the solid angle of the pixel and cos that of
/// the angle between ray and normal (the change of variables of the rendering equation from
/// directions to areas: pbrt, 4th ed., section 4.2.3; docs/references.md [20]). A pixel of side p
/// at the eye's distance f, at an angle a off the axis, has dOmega = p^2 cos^3(a) / f^2. In
/// parallel projection dA = p^2 / |cos|. The pixel must show a surface.
double pixel_area_m2(const Truth& truth, const render::Camera& camera, int column, int row);
/// The area of any surface that a pixel shows, at a depth and with a normal.
double pixel_area_m2(const render::Camera& camera,
                     const hw::Ray& ray,
                     double depth_m,
                     const glm::dvec3& normal);

}  // namespace wobblebench::bench
