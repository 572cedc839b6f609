// Pictures, z-buffer and pass times: the output of the renderer.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/image.h"
#include "render/gl/texels.h"

namespace wobblebench::render {

/// Time and texture fetches of one pass. `ms` is wall time between glFinish calls; `gpu_ms` is the
/// driver's timer query, negative if there is none.
struct PassTime {
  std::string name;
  double ms = 0;
  double gpu_ms = -1;
  FetchCounts fetches;  ///< empty unless a FetchCounter exists
};

/// Levels of the echoes that the detectors `iso` and `floor` measure in the volume of interest, for
/// samples in [0, 1].
struct SurfaceLevels {
  double fluid = 0;
  double tissue = 0;
  /// False where the samples are of one kind: then nothing is a surface.
  bool separate = false;
  /// Lowest and highest level of the sticks' surfaces, where each has its own.
  std::optional<std::pair<double, double>> of_sticks;
};

/// A rendered picture.
///
/// @code
/// render::Picture picture;
/// picture.depth_m = Image<float>(512, 512, kNoSurface);
/// double total_ms = 0;
/// for (const render::PassTime& pass : picture.passes) total_ms += pass.ms;
/// const bool is_surface = picture.depth_m.at(256, 256) > 0;
/// static_cast<void>(is_surface);
/// @endcode
struct Picture {
  Image<glm::vec3> surface;  ///< shaded and smoothed: light, linear RGB in [0, 1]
  /// Alpha-blended grey levels of the echoes in [0, 1]: display values, as of a scanner's picture.
  Image<glm::vec3> volume;
  /// z of pass 2, or its replacement: ray length from the view plane (parallel) or the eye
  /// (perspective); kNoSurface.
  Image<float> depth_m;
  /// 1: z was not found there but continues the surface (RayCastingOptions::outline_m). Empty: all
  /// of z was found, or replaced.
  Image<std::uint8_t> drawn;
  Image<float> filtered_depth_m;  ///< z after pass 3's homogeneous filter
  /// scan_conversion, ray_casting, surface_shading, smoothing; behind ray_casting `correction`,
  /// where a tap (RenderTaps::depth) has replaced z. Without ray_casting where rays were kept
  /// (Renderer::render()).
  std::vector<PassTime> passes;
  std::optional<SurfaceLevels> levels;  ///< none: no setting needs them
};

}  // namespace wobblebench::render
