// How a phantom lies before the probe, and the box that the renderer looks into, where the scene
// does not say.
#pragma once

#include <glm/mat3x3.hpp>
#include <memory>
#include <vector>

#include "phantoms/phantom.h"

namespace wobblebench::phantoms {

/// Depth of every region of interest: the renderer's step along the ray, and with it the meaning of
/// a threshold, is the same for each phantom.
inline constexpr double kBoxDepth_m = 60e-3;

struct Framing {
  /// Axes of the probe frame, relative to the phantom's origin; starts in the fluid.
  Box region_of_interest;
  /// Position of the phantom's origin in the frame of the default probe, whose face is at z = 40
  /// mm.
  glm::dvec3 position_m{0};
};

/// Framing of the phantom turned by `rotation` about its origin. A built-in phantom's region turns
/// with it; an imported body's is that of the turned body, whichever of its sides then faces the
/// probe: its front 65 mm below the face, its middle on the axis of the probe.
[[nodiscard]] Framing framing(const Phantom& phantom, const glm::dmat3& rotation);

/// Throws std::invalid_argument, with size and limit, if a body with these bounds is larger than
/// 500 mm or smaller than 4 voxels.
void check_size(const Box& bounds, double voxel_m);

/// The imported phantom of these surfaces, which lie within `bounds`; the bounds' centre is the
/// origin.
Phantom imported_phantom(const PhantomOptions& options,
                         std::vector<Surface> surfaces,
                         const Box& bounds,
                         std::shared_ptr<const Grids> grids);

}  // namespace wobblebench::phantoms
