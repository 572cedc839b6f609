// Each GL pass against the same pass of the double-precision reference, on the same input.
#pragma once

#include <string>
#include <vector>

#include "hw/probe/polar_volume.h"
#include "render/renderer.h"

namespace wobblebench::bench {

/// What each pass made.
struct PassPictures {
  render::VolumeSlices slices;
  render::CastDepth depth;
  Image<glm::vec3> shaded;
  render::Picture picture;
};

/// By the renderer's taps. Throws as its constructor and add_volume() do.
PassPictures run_passes(const hw::PolarVolume& volume,
                        const render::RenderOptions& options,
                        render::GlContext& context);

/// Of slices and colours relative to full scale, of depths to the length of the ray.
struct PassError {
  std::string pass;
  double worst = 0;  ///< greatest difference
  double bound = 0;  ///< greatest difference that the bounds of its pixels allow
  long compared = 0;
  long outside = 0;  ///< pixels beyond their own bound
};

/// z is where a detector first decides, so no error of z is bounded by itself. A pixel is within
/// its bound if its z lies in the span of the reference's z for thresholds moved by the
/// detector's bound and pictures moved by the position's; a pixel without a surface counts as z at
/// infinity. So is a shaded pixel whose shadow begins or ends within the rounding of positions.
///
/// `meant`: the volume in samples of [0, 1], which the reference is given.
std::vector<PassError> pass_errors(const PassPictures& pictures,
                                   const hw::PolarVolume& meant,
                                   const render::RenderOptions& options);

}  // namespace wobblebench::bench
