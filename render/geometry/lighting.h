// Position and direction of the light of pass 3.
#pragma once

#include <glm/vec3.hpp>

#include "render/camera.h"
#include "render/options.h"

namespace wobblebench::render {

/// Unit vector from the centre of the volume of interest towards the light, in the viewer's axes
/// (right, down, forward); (0, 0, -1) points to the viewer.
glm::dvec3 light_direction(const ShadingOptions& options);

/// Position of the point light in the viewer's axes, relative to the middle of the view plane
/// (parallel) or the eye (perspective).
glm::dvec3 light_position_m(const ShadingOptions& options, const Camera& camera);

/// The same in the probe frame.
glm::dvec3 light_position_in_probe_m(const ShadingOptions& options, const Camera& camera);
glm::dvec3 light_direction_in_probe(const ShadingOptions& options, const Camera& camera);

/// Upper bound of the steps of a shadow trace, which crosses one pixel of the picture per step.
constexpr int max_shadow_steps(int image_size) {
  return 4 * image_size + 4;
}

}  // namespace wobblebench::render
