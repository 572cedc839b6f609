// The true surface of each pixel of a picture.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>

#include "base/image.h"
#include "hw/probe/acquisition_plan.h"
#include "phantoms/placed_phantom.h"
#include "render/view.h"

namespace wobblebench::bench {

enum class TruthKind : std::uint8_t {
  none,           ///< the ray crosses no surface in the box of interest
  surface,        ///< it crosses one within the probe's field
  outside_field,  ///< it crosses one that no stick reaches: outside sector, fan or depth
};

/// One value per pixel, in the picture's geometry.
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
};

/// First crossing, within the view's box, from fluid into tissue (or, for EdgeSign::falling, from
/// tissue into fluid) along the ray of each pixel. Moving tissue is at its position at the time of
/// the stick that images the point (nearest frame and line) in this volume of the plan.
Truth trace_truth(const phantoms::PlacedPhantom& subject,
                  const hw::AcquisitionPlan& plan,
                  const render::View& view,
                  std::uint32_t volume = 0);

}  // namespace wobblebench::bench
