// What the renderer hands out.
#pragma once

#include <glm/vec3.hpp>
#include <string>
#include <vector>

#include "base/image.h"
#include "render/gl/texture_fetch.h"

namespace wobblebench::render {

/// One pass's cost. `ms` is wall time between glFinish calls; `gpu_ms` is the driver's timer query
/// (negative where there is none).
struct PassTime {
  std::string name;
  double ms = 0;
  double gpu_ms = -1;
  FetchCounts fetches;  ///< none, unless a FetchCounter lives
};

struct Picture {
  Image<glm::vec3> surface;  ///< shaded and smoothed, linear RGB in [0, 1]
  Image<glm::vec3> volume;   ///< alpha-blended, linear RGB in [0, 1]
  Image<float>
      depth_m;  ///< pass 2's z: ray length from the view plane (parallel) or eye; kNoSurface
  Image<float> filtered_depth_m;  ///< pass 3's z after its box filter
  std::vector<PassTime> passes;   ///< scan_conversion, ray_casting, surface_shading, smoothing
};

}  // namespace wobblebench::render
