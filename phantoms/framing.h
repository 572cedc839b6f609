// How a phantom lies before the probe, and the box that the renderer looks into, where the scene
// does not say.
#pragma once

#include <glm/mat3x3.hpp>

#include "phantoms/phantom.h"

namespace wobblebench::phantoms {

struct Framing {
  /// Axes of the probe frame, relative to the phantom's origin; starts in the fluid.
  Box region_of_interest;
  /// Of the phantom's origin in the frame of the default probe, whose face is at z = 40 mm.
  glm::dvec3 position_m{0};
};

/// Of the phantom turned by `rotation` about its origin. A built-in phantom's region turns with it;
/// an imported body's is that of the turned body, whichever of its sides then faces the probe.
[[nodiscard]] Framing framing(const Phantom& phantom, const glm::dmat3& rotation);

/// Of an imported body whose surfaces lie within `bounds` (axes of the probe frame, relative to the
/// origin): its front 65 mm below the face, its middle on the axis of the probe.
[[nodiscard]] Framing framing_of_body(const Box& bounds);

}  // namespace wobblebench::phantoms
