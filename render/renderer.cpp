#include "render/renderer.h"

#include <utility>

#include "render/gl_timer.h"
#include "render/ray_caster.h"
#include "render/scan_converter.h"
#include "render/smoother.h"
#include "render/surface_shader.h"

namespace wobblebench::render {
namespace {

Image<glm::vec3> download_rgb(const Texture& rgba) {
  Image<glm::vec3> image(rgba.extent().width, rgba.extent().height);
  const std::vector<float> texels = rgba.download();
  for (std::size_t i = 0; i < image.pixels.size(); ++i) {
    image.pixels[i] = {texels[4 * i], texels[4 * i + 1], texels[4 * i + 2]};
  }
  return image;
}

Image<float> download_depth(const Texture& depth) {
  Image<float> image(depth.extent().width, depth.extent().height);
  image.pixels = depth.download();
  for (float& z : image.pixels) {
    if (z < 0) z = kNoSurface;
  }
  return image;
}

}  // namespace

struct Renderer::Passes {
  Passes(GlContext& gl, const hw::AcquisitionPlan& plan, const RenderOptions& options)
      : context(gl),
        scan_converter(plan, options.scan_conversion),
        ray_caster(scan_converter.geometry(), options),
        surface_shader(options),
        smoother(options.smoothing, options.ray_casting.image_size) {}

  template <class Pass>
  PassTime timed(const char* name, Pass pass) {
    PassTime time{name};
    timer.begin();
    pass();
    timer.end(time);
    return time;
  }

  GlContext& context;
  ScanConverter scan_converter;
  RayCaster ray_caster;
  SurfaceShader surface_shader;
  Smoother smoother;
  PassTimer timer;
  PassTime scan_conversion{"scan_conversion"};
};

Renderer::Renderer(GlContext& context,
                   const hw::AcquisitionPlan& plan,
                   const RenderOptions& options) {
  validate(options);
  context.make_current();
  passes_ = std::make_unique<Passes>(context, plan, options);
}

Renderer::~Renderer() {
  passes_->context.make_current();
}

void Renderer::add_frame(int frame_index, const hw::PolarFrame& frame) {
  passes_->context.make_current();
  passes_->timer.begin();
  passes_->scan_converter.convert(frame_index, frame);
  passes_->timer.end(passes_->scan_conversion);
}

Picture Renderer::render() {
  Passes& p = *passes_;
  p.context.make_current();
  Picture picture;
  picture.passes.push_back(std::exchange(p.scan_conversion, {"scan_conversion"}));
  picture.passes.push_back(
      p.timed("ray_casting", [&] { p.ray_caster.cast(p.scan_converter.slices()); }));
  picture.passes.push_back(
      p.timed("surface_shading", [&] { p.surface_shader.shade(p.ray_caster.depth()); }));
  picture.passes.push_back(
      p.timed("smoothing", [&] { p.smoother.smooth(p.surface_shader.surface()); }));
  picture.surface = download_rgb(p.smoother.smoothed());
  picture.volume = download_rgb(p.ray_caster.color());
  picture.depth_m = download_depth(p.ray_caster.depth());
  picture.filtered_depth_m = download_depth(p.surface_shader.filtered_depth());
  check_gl("reading the picture");
  return picture;
}

Picture render_volume(GlContext& context,
                      const hw::PolarVolume& volume,
                      const RenderOptions& options) {
  Renderer renderer(context, volume.plan(), options);
  int index = 0;
  for (const hw::PolarFrame& frame : volume.frames()) renderer.add_frame(index++, frame);
  return renderer.render();
}

}  // namespace wobblebench::render
