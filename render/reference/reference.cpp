#include "render/reference/reference.h"

#include <algorithm>
#include <string>

#include "render/reference/reference_passes.h"

namespace wobblebench::render {
namespace {

template <class Pixel, class From>
Image<Pixel> converted(const Image<From>& image) {
  Image<Pixel> result(image.width, image.height);
  std::transform(image.pixels.begin(), image.pixels.end(), result.pixels.begin(), [](From pixel) {
    return Pixel(pixel);
  });
  return result;
}

/// Passes 3 and 4.
void shade_and_smooth(const Image<double>& depth_m,
                      const RenderOptions& options,
                      Picture& picture) {
  const auto filtered = reference::filter_depth(depth_m, options.shading.depth_filter_size);
  const auto shaded = reference::shade(filtered, options);
  picture.depth_m = converted<float>(depth_m);
  picture.filtered_depth_m = converted<float>(filtered);
  picture.surface = converted<glm::vec3>(reference::smooth(shaded, options.smoothing));
}

}  // namespace

Picture render_reference(const hw::PolarVolume& volume, const RenderOptions& options) {
  validate(options);
  const reference::SliceStack slices(volume, options);
  const reference::Cast cast = reference::cast_rays(slices, options);
  Picture picture;
  picture.volume = converted<glm::vec3>(cast.volume);
  shade_and_smooth(cast.depth_m, options, picture);
  return picture;
}

Picture shade_depth(const Image<float>& depth_m, const RenderOptions& options) {
  validate(options);
  const int size = options.ray_casting.image_size;
  if (depth_m.width != size || depth_m.height != size) {
    throw InvalidOption("ray_casting.image_size",
                        std::to_string(size),
                        "the depth image is " + std::to_string(depth_m.width) + " x " +
                            std::to_string(depth_m.height));
  }
  Picture picture;
  picture.volume = Image<glm::vec3>(size, size);
  shade_and_smooth(converted<double>(depth_m), options, picture);
  return picture;
}

}  // namespace wobblebench::render
