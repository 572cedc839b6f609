#include "render/reference/reference.h"

#include <algorithm>
#include <string>

#include "render/passes/outline.h"
#include "render/reconstruction/frame_store.h"
#include "render/reference/reference_passes.h"

namespace wobblebench::render {
namespace {

template <class Pixel>
void check_size(const std::string& what, const Image<Pixel>& image, const RenderOptions& options) {
  const int size = options.ray_casting.image_size;
  if (image.width == size && image.height == size) return;
  throw InvalidOption(
      "ray_casting.image_size",
      std::to_string(size),
      what + " is " + std::to_string(image.width) + " x " + std::to_string(image.height));
}

/// Passes 3 and 4.
void shade_and_smooth(const Image<double>& depth_m,
                      const Image<glm::dvec3>& rendered,
                      const RenderOptions& options,
                      Picture& picture) {
  const auto filtered = reference::filter_depth(depth_m, options.shading.depth_filter_size);
  const auto shaded = reference::shade(filtered, rendered, options);
  picture.depth_m = converted<float>(depth_m);
  picture.filtered_depth_m = converted<float>(filtered);
  picture.surface = converted<glm::vec3>(reference::smooth(shaded, options.smoothing));
}

}  // namespace

Picture render_reference(const hw::PolarVolume& volume, const RenderOptions& options) {
  validate(options);
  check_log_compressed(volume);
  const reference::SliceStack slices(volume, options);
  const reference::Cast cast = reference::cast_rays(slices, options);
  Picture picture;
  picture.volume = converted<glm::vec3>(cast.volume);
  const auto found_m = reference::correct_incidence(cast.depth_m, volume.plan(), options);
  const auto depth_m = finished_surface(found_m, volume.plan().geometry(), options);
  if (options.ray_casting.outline_m > 0) picture.drawn = drawn_beyond(found_m, depth_m);
  shade_and_smooth(depth_m, cast.volume, options, picture);
  return picture;
}

Picture shade_depth(const Image<float>& depth_m,
                    const RenderOptions& options,
                    const Image<glm::vec3>& rendered) {
  validate(options);
  check_size("the depth image", depth_m, options);
  Picture picture;
  const int size = options.ray_casting.image_size;
  picture.volume = rendered.pixels.empty() ? Image<glm::vec3>(size, size) : rendered;
  check_size("the volume picture", picture.volume, options);
  shade_and_smooth(
      converted<double>(depth_m), converted<glm::dvec3>(picture.volume), options, picture);
  return picture;
}

}  // namespace wobblebench::render
