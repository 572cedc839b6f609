// What the renderer hands out.
#pragma once

#include <cstddef>
#include <glm/vec3.hpp>
#include <limits>
#include <string>
#include <vector>

#include "render/gl/texture_fetch.h"

namespace wobblebench::render {

/// Row-major picture; row 0 is the top.
template <class Pixel>
struct Image {
  int width = 0;
  int height = 0;
  std::vector<Pixel> pixels;

  Image() = default;
  Image(int w, int h, Pixel fill = {})
      : width(w),
        height(h),
        pixels(static_cast<std::size_t>(w) * static_cast<std::size_t>(h), fill) {}
  Pixel& at(int column, int row) {
    return pixels[static_cast<std::size_t>(row) * static_cast<std::size_t>(width) +
                  static_cast<std::size_t>(column)];
  }
  const Pixel& at(int column, int row) const { return const_cast<Image*>(this)->at(column, row); }
};

/// Depth of a pixel where no surface was found.
inline constexpr float kNoSurface = std::numeric_limits<float>::quiet_NaN();

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
