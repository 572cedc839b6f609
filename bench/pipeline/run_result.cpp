#include "bench/pipeline/run_result.h"

#include <cmath>

#include "render/reference/reference.h"

namespace wobblebench::bench {

namespace {

/// The window of the similarity index; smaller images have none.
constexpr int kLeastImageSize = 11;

ImageSimilarity compare_with_shaded_truth(const render::Picture& picture,
                                          const Truth& truth,
                                          const render::RenderOptions& options) {
  if (options.ray_casting.image_size < kLeastImageSize) return {HUGE_VAL, HUGE_VAL};
  const auto shaded = render::shade_depth(truth.depth_m, options, picture.volume);
  return compare_images(picture.surface, shaded.surface);
}

}  // namespace

PictureError measure_picture_error(const render::Picture& picture,
                                   const Truth& truth,
                                   const render::RenderOptions& options) {
  const render::Camera camera = render::make_camera(options);
  return {measure_depth_error(picture.depth_m, truth, camera),
          measure_depth_error(picture.filtered_depth_m, truth, camera),
          compare_with_shaded_truth(picture, truth, options)};
}

}  // namespace wobblebench::bench
