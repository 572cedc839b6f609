#include "render/renderer.h"

#include <algorithm>
#include <utility>

#include "render/gl/fetch_count.h"
#include "render/gl/timer.h"
#include "render/passes/ray_caster.h"
#include "render/passes/slice_volume.h"
#include "render/passes/smoother.h"
#include "render/passes/surface_shader.h"

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

constexpr const char* kScanConversion = "scan_conversion";

/// Which way the motor turned while the frame was taken; forwards where it rested.
int sweep_of(const hw::PolarFrame& frame) {
  const auto& angles = frame.motor_angle_rad;
  return !angles.empty() && angles.back() < angles.front() ? -1 : 1;
}

}  // namespace

struct Renderer::Passes {
  Passes(GlContext& gl, const hw::AcquisitionPlan& acquisition_plan, const RenderOptions& given)
      : context(gl),
        plan(acquisition_plan),
        options(given),
        maker(plan, options),
        frames(maker.make_store()),
        arriving(maker.make()),
        ray_caster(make_ray_caster()),
        surface_shader(options),
        smoother(options.smoothing, options.ray_casting.image_size, options.pipeline.mode) {
    if (!options.pipeline.mid_volume) complete = maker.make();
  }

  RayCaster make_ray_caster() const { return {maker.geometry(), options, *arriving}; }

  void make_layers() {
    const std::vector<int> layers =
        options.pipeline.mid_volume ? frames.take_changed() : frames.take_settled();
    if (!layers.empty()) arriving->make_layers(layers, frames);
    if (!frames.volume_complete()) return;
    frames.begin_volume();
    if (complete) std::swap(arriving, complete);
  }

  void cast() { ray_caster.cast(complete ? *complete : *arriving); }

  template <class Pass>
  PassTime timed(const char* name, Pass pass) {
    PassTime time{name};
    timer.begin();
    pass();
    timer.end(time);
    if (FetchCounter* counter = FetchCounter::current()) time.fetches = counter->take();
    return time;
  }

  GlContext& context;
  hw::AcquisitionPlan plan;
  RenderOptions options;
  SliceVolumeMaker maker;
  FrameStore frames;
  std::unique_ptr<SliceVolume> arriving;  ///< what frames go into
  std::unique_ptr<SliceVolume> complete;  ///< the last that is; none: `arriving` is shown
  RayCaster ray_caster;
  SurfaceShader surface_shader;
  Smoother smoother;
  PassTimer timer;
  PassTime scan_conversion{kScanConversion};
  bool has_news = false;  ///< frames that update() has not seen
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
  passes_->frames.put(frame_index, frame);
  passes_->arriving->sweep = sweep_of(frame);
  passes_->has_news = true;
}

void Renderer::add_volume(const hw::PolarVolume& volume) {
  int index = 0;
  for (const hw::PolarFrame& frame : volume.frames()) add_frame(index++, frame);
}

PassTime Renderer::update() {
  Passes& p = *passes_;
  if (!std::exchange(p.has_news, false)) return {kScanConversion, 0, 0};
  p.context.make_current();
  PassTime time = p.timed(kScanConversion, [&] { p.make_layers(); });
  p.scan_conversion.ms += time.ms;
  p.scan_conversion.gpu_ms = std::max(p.scan_conversion.gpu_ms, 0.0) + time.gpu_ms;
  for (const auto& [kind, count] : time.fetches) p.scan_conversion.fetches[kind] += count;
  return time;
}

void Renderer::look(const ViewOptions& view) {
  Passes& p = *passes_;
  RenderOptions options = p.options;
  options.view = view;
  validate(options);
  p.context.make_current();
  const bool turned_only = view.projection == p.options.view.projection &&
                           view.eye_distance_m == p.options.view.eye_distance_m;
  p.options = options;
  p.arriving->look(options);
  if (p.complete) p.complete->look(options);
  if (turned_only) {
    p.ray_caster.look(options);  // lights turn with the viewer: pass 3 stays as it is
    return;
  }
  p.ray_caster = p.make_ray_caster();
  p.surface_shader = SurfaceShader(options);
}

Picture Renderer::render() {
  update();
  Passes& p = *passes_;
  p.context.make_current();
  Picture picture;
  picture.passes.push_back(std::exchange(p.scan_conversion, {kScanConversion}));
  picture.passes.push_back(p.timed("ray_casting", [&] { p.cast(); }));
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
  renderer.add_volume(volume);
  return renderer.render();
}

}  // namespace wobblebench::render
