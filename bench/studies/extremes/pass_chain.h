// The renderer's passes one after the other, with what each of them made.
#pragma once

#include <glm/vec3.hpp>
#include <vector>

#include "base/image.h"
#include "hw/probe/polar_volume.h"
#include "render/gl/region.h"
#include "render/options.h"
#include "render/reconstruction/echo_levels.h"

namespace wobblebench::bench {

/// Depths are NaN where there is no surface.
struct PassPictures {
  render::Region pixels;             ///< of a slice, those that rays read
  std::vector<Image<float>> slices;  ///< [frame], of `pixels`
  render::EchoLevels levels;         ///< of fluid and tissue; as in no volume where not needed
  Image<float> cast_m;               ///< z of pass 2
  Image<glm::vec3> volume;           ///< blended by pass 2
  Image<float> corrected_m;          ///< behind the correction for incidence
  Image<float> filtered_m;           ///< of pass 3
  Image<glm::vec3> shaded;           ///< of pass 3
  Image<glm::vec3> smoothed;         ///< of pass 4
};

/// As render::Renderer draws them. The context is current on this thread. Throws InvalidOption, and
/// std::runtime_error beyond the driver's limits.
PassPictures run_passes(const hw::PolarVolume& volume, const render::RenderOptions& options);

}  // namespace wobblebench::bench
