// The surface that each pixel should show.
#pragma once

#include <glm/vec3.hpp>

#include "hw/probe/acquisition_plan.h"
#include "phantoms/placed_phantom.h"
#include "render/options.h"
#include "render/picture.h"

namespace wobblebench::bench {

enum class TruthKind : std::uint8_t {
  none,           ///< the ray meets no surface in the box of interest
  surface,        ///< and the probe can see it
  outside_field,  ///< it meets one that no stick reaches: outside sector, fan or depth
};

/// One value a pixel, in the picture's own geometry.
struct Truth {
  Image<float> depth_m;     ///< kNoSurface where kind is not `surface`
  Image<glm::vec3> normal;  ///< unit, out of the tissue, probe frame
  Image<TruthKind> kind;
};

/// First crossing, within the box of interest, from fluid into tissue (or, for EdgeSign::falling,
/// from tissue into fluid) along the ray of each pixel. What moves is where it is at the time of
/// the stick that shows the place (that of the nearest frame and line, in the first volume of the
/// plan).
Truth trace_truth(const phantoms::PlacedPhantom& subject,
                  const hw::AcquisitionPlan& plan,
                  const render::RenderOptions& options);

}  // namespace wobblebench::bench
