// What a picture shows: its camera, its box of interest and the kind of edge that is a surface.
#pragma once

#include "render/camera.h"
#include "render/options.h"

namespace wobblebench::render {

/// The part of RenderOptions that decides which surface point a pixel shows.
///
/// @code
/// #include <cstdio>
///
/// render::RenderOptions options;
/// options.view.yaw_rad = 30 * kDegree;
/// const render::View view = render::make_view(options);
/// const hw::Ray ray = view.camera.ray(0, 0);  // of the upper left pixel's centre
/// const render::Span span = render::clip_to_box(ray, view.box);
/// std::printf("in the box from %g to %g m\n", span.from_m, span.to_m);
/// @endcode
struct View {
  Camera camera;
  VolumeOfInterest box;
  EdgeSign edge = EdgeSign::rising;
};

inline View make_view(const RenderOptions& options) {
  return {make_camera(options), options.volume_of_interest, options.ray_casting.edge};
}

}  // namespace wobblebench::render
