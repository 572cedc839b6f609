// What pass 2 may give: the reference's pictures for settings within the rounding of their own.
#pragma once

#include <functional>
#include <vector>

#include "bench/studies/extremes/pass_bounds.h"
#include "bench/studies/extremes/pixel_spans.h"
#include "render/reconstruction/echo_levels.h"

namespace wobblebench::bench {

struct CastSpans {
  Image<double> depth_m;      ///< of the settings themselves
  Image<glm::dvec3> volume;   ///< likewise
  PixelSpans<double> depths;  ///< with those of thresholds and pictures moved by their bounds
  PixelSpans<glm::dvec3> volumes;
};

/// `enough`: whether the spans of moved thresholds alone will do; pictures are not moved then.
CastSpans cast_spans(const render::reference::SliceStack& slices,
                     const hw::PolarVolume& volume,
                     const render::RenderOptions& options,
                     const PassBounds& bounds,
                     const render::EchoLevels& levels,
                     const std::function<bool(const CastSpans&)>& enough);

/// Settings with the light turned by as much as moves a shadow by `position_m` within a pixel, and
/// with its bias changed by that much.
std::vector<render::RenderOptions> moved_lights(const render::RenderOptions& options,
                                                double position_m);

}  // namespace wobblebench::bench
