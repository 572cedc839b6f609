// Where the light of pass 3 is.
#pragma once

#include <glm/vec3.hpp>

#include "render/camera.h"
#include "render/options.h"

namespace wobblebench::render {

/// Unit vector from the picture's middle towards the light, in the viewer's axes (right, down,
/// forward): (0, 0, -1) is the viewer's own direction.
glm::dvec3 light_direction(const ShadingOptions& options);

/// The point light in the viewer's axes, from the middle of the view plane (parallel) or the eye.
glm::dvec3 light_position_m(const ShadingOptions& options, const Camera& camera);

/// The same place in the probe frame.
glm::dvec3 light_position_in_probe_m(const ShadingOptions& options, const Camera& camera);
glm::dvec3 light_direction_in_probe(const ShadingOptions& options, const Camera& camera);

/// A shadow's trace crosses one pixel a step, so it leaves the picture in fewer steps than this.
constexpr int max_shadow_steps(int image_size) {
  return 4 * image_size + 4;
}

}  // namespace wobblebench::render
