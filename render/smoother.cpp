#include "render/smoother.h"

namespace wobblebench::render {
namespace {

enum Bindings { kPicture };

}  // namespace

Smoother::Smoother(const SmoothingOptions& options, int image_size) {
  smoothed_ = Texture("ray_casting.image_size = " + std::to_string(image_size),
                      TexelFormat::rgba32f,
                      {image_size, image_size},
                      TextureFilter::nearest);
  target_ = Framebuffer({&smoothed_});
  filter_ = FragmentProgram({"smooth.frag.glsl"},
                            Defines()
                                .add("BIND_PICTURE", kPicture)
                                .add("HALF_FILTER", options.filter_size / 2)
                                .add("BILATERAL", options.filter == SmoothingFilter::bilateral));
  filter_.set("range_sigma", options.range_sigma)
      .set("spatial_sigma", bilateral_spatial_sigma(options.filter_size));
  check_gl("smoothing: setting up");
}

void Smoother::smooth(const Texture& picture) {
  filter_.draw(target_, {{kPicture, &picture}});
  check_gl("smoothing");
}

}  // namespace wobblebench::render
