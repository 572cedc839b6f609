#include "bench/studies/extremes/cast_spans.h"

#include <algorithm>
#include <cmath>

#include "render/camera.h"

namespace wobblebench::bench {

namespace {

using render::RenderOptions;
using render::reference::SliceStack;

/// The same with what the detector compares moved by `by`, in full scales.
RenderOptions with_threshold(RenderOptions options, const render::EchoLevels& levels, double by) {
  render::RayCastingOptions& o = options.ray_casting;
  if (o.detector == render::Detector::paper) {
    o.threshold += by;
  } else if (levels.separate) {
    o.iso_level += by / (levels.tissue - levels.fluid);
  }
  return options;
}

void include(CastSpans& spans, const SliceStack& slices, const RenderOptions& options) {
  const render::reference::Cast cast = cast_rays(slices, options);
  spans.depths.include(cast.depth_m);
  spans.volumes.include(cast.volume);
}

/// The picture and, as a box moves with it, where its rays begin, along an axis of the probe frame.
void include_moved(CastSpans& spans,
                   const SliceStack& slices,
                   const RenderOptions& options,
                   double by_m) {
  for (int axis = 0; axis < 3; ++axis) {
    for (const double side : {-1.0, 1.0}) {
      RenderOptions moved = options;
      moved.volume_of_interest.center_m[axis] += side * by_m;
      include(spans, slices, moved);
    }
  }
}

}  // namespace

CastSpans cast_spans(const SliceStack& slices,
                     const hw::PolarVolume& volume,
                     const RenderOptions& options,
                     const PassBounds& bounds,
                     const render::EchoLevels& levels,
                     const std::function<bool(const CastSpans&)>& enough) {
  const render::reference::Cast cast = cast_rays(slices, options);
  CastSpans spans{cast.depth_m, cast.volume, PixelSpans(cast.depth_m), PixelSpans(cast.volume)};
  if (!std::isfinite(bounds.detector)) {
    spans.depths.include_all();
    spans.volumes.include_all();
    return spans;
  }
  const auto stack = [&](const RenderOptions& moved) {
    // Detectors other than the paper's take their level from the stack.
    return options.ray_casting.detector == render::Detector::paper ? slices
                                                                   : SliceStack(volume, moved);
  };
  const RenderOptions less = with_threshold(options, levels, -bounds.detector),
                      more = with_threshold(options, levels, bounds.detector);
  include(spans, stack(less), less);
  include(spans, stack(more), more);
  if (enough(spans)) return spans;
  for (const RenderOptions& moved : {options, less, more}) {
    include_moved(spans, stack(moved), moved, bounds.place_m);
  }
  return spans;
}

std::vector<RenderOptions> moved_lights(const RenderOptions& options, double position_m) {
  const double turn_rad = std::min(position_m / make_camera(options).pixel_m(), 0.1);
  std::vector<RenderOptions> moved;
  for (const double side : {-1.0, 1.0}) {
    for (double render::ShadingOptions::*angle :
         {&render::ShadingOptions::light_left_rad, &render::ShadingOptions::light_up_rad}) {
      moved.push_back(options);
      moved.back().shading.*angle += side * turn_rad;
    }
    moved.push_back(options);
    moved.back().shading.shadow_bias_m += side * position_m;
  }
  return moved;
}

}  // namespace wobblebench::bench
