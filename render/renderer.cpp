#include "render/renderer.h"

#include <algorithm>
#include <exception>
#include <numeric>
#include <optional>
#include <stdexcept>
#include <utility>

#include "hw/probe/beam_width.h"
#include "hw/probe/polar_volume.h"
#include "render/gl/fetch_count.h"
#include "render/gl/host_state.h"
#include "render/gl/objects.h"
#include "render/gl/program.h"
#include "render/gl/timer.h"
#include "render/passes/outline.h"
#include "render/passes/ray_caster.h"
#include "render/passes/slice_volume.h"
#include "render/passes/smoother.h"
#include "render/passes/surface_depth.h"
#include "render/passes/surface_shader.h"
#include "render/reconstruction/frame_store.h"
#include "render/reconstruction/reconstruction.h"

namespace wobblebench::render {
namespace {

constexpr const char* kScanConversion = "scan_conversion";

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

/// The inverse, into a texture that is made where it has another size.
void upload_depth(Image<float> depth_m, Texture& texture) {
  for (float& z : depth_m.pixels) {
    if (!(z >= 0)) z = kNoDepth;
  }
  if (!texture || texture.extent().width != depth_m.width) {
    texture = Texture(
        "replaced z", TexelFormat::r32f, {depth_m.width, depth_m.height}, TextureFilter::nearest);
  }
  texture.upload(depth_m.pixels);
}

/// Direction of the motor's rotation during the frame, as hw::AcquisitionPlan::sweep_direction; +1
/// if it rests.
int sweep_of(const hw::PolarFrame& frame) {
  const auto& angles = frame.motor_angle_rad;
  return !angles.empty() && angles.back() < angles.front() ? -1 : 1;
}

}  // namespace

/// The four passes and the textures between them, one function per pass (paper Fig. 2).
struct Renderer::Pipeline {
  Pipeline(GlContext& gl, const hw::AcquisitionPlan& of, const RenderOptions& given)
      : context(gl),
        plan(of),
        options(given),
        factory(plan, options),
        reconstruction(plan, options),
        frames(plan, options),
        incoming(factory.make()),
        ray_caster(make_ray_caster()),
        incidence(make_incidence(options)),
        surface_shader(options),
        smoother(options.smoothing, options.ray_casting.image_size, options.pipeline.mode) {
    if (!options.pipeline.mid_volume) complete = factory.make();
  }

  /// Pass 1, paper section 3.1: polar frames to Cartesian slices.
  void convert_frames() {
    if (!reconstruct()) return;
    const std::vector<int> layers =
        options.pipeline.mid_volume ? frames.take_changed() : frames.take_complete();
    if (!layers.empty()) incoming->make_layers(layers, frames);
    if (!complete) has_cast = false;
    if (!frames.volume_complete()) return;
    frames.begin_volume();
    has_cast = false;
    if (!complete) return;
    std::swap(incoming, complete);
    std::swap(incoming_levels, complete_levels);
  }

  /// Before pass 1: levels of fluid and tissue, sticks between the sticks if asked for, and sticks
  /// at the plan's angles where the motor was not there. False: the volume is not whole, which
  /// aligned sticks wait for.
  bool reconstruct() {
    const bool whole = frames.volume_complete();
    if (reconstruction.waits_for_volume() && !whole) return false;
    if (!whole && !options.pipeline.mid_volume) return true;
    const MotorAngles angles = frames.angles();
    const double steps = factory.geometry().frames_per_planned_frame();
    incoming->set_covered({steps * angles.covered.first, steps * angles.covered.last});
    if (!angles.as_planned()) incoming->sweep = 1;
    const EchoLevels levels =
        needs_levels(options) ? reconstruction.levels(frames.received(), angles) : EchoLevels();
    if (!reconstruction.makes_frames(angles)) {
      set_incoming_levels(levels, {});
      frames.drop_aligned();
      return true;
    }
    const hw::BeamWidths* widths = has_stick_levels(options) ? &beam_widths() : nullptr;
    const auto sticks = reconstruction.prepare(frames.received(), angles, levels, widths);
    set_incoming_levels(levels, sticks);
    frames.put_aligned(
        reconstruction.frames(frames.received(), angles, sticks, frames.take_aligned()));
    return true;
  }

  void set_incoming_levels(const EchoLevels& levels, const PreparedSticks& sticks) {
    if (!needs_levels(options)) return;
    incoming_levels = {levels.fluid, levels.tissue, levels.separate};
    if (!sticks.levelled.empty()) incoming_levels->of_sticks = sticks.range;
    incoming->set_level(detection_level(levels, options.ray_casting));
  }

  const hw::BeamWidths& beam_widths() {
    if (!beam) beam.emplace(plan);
    return *beam;
  }

  /// One pixel of each draw of all passes, of an empty volume; and what the first volume would
  /// compute once.
  void compile() {
    if (has_stick_levels(options)) beam_widths();
    const DrawsOfOnePixel draws;
    std::vector<int> layers(static_cast<std::size_t>(incoming->slices().extent().depth));
    std::iota(layers.begin(), layers.end(), 0);
    incoming->make_layers(layers, frames);
    cast_rays();
    shade_surface();
    smooth_picture();
    has_cast = false;
  }

  /// Pass 2, section 3.2: slices to z-buffer and volume picture.
  void cast_rays() {
    has_cast = false;
    ray_caster.cast(complete ? *complete : *incoming);
    depth = &incidence.correct(ray_caster.depth());
    finish_outline();
    has_cast = !taps.depth;
  }

  /// On the CPU, which follows an outline or a piece wherever it goes; a shader would need a pass
  /// for each pixel of its longest way.
  void finish_outline() {
    drawn = {};
    const RayCastingOptions& casting = options.ray_casting;
    if (casting.mode == RenderMode::volume) return;
    if (casting.outline_m == 0 && casting.smallest_piece_m2 == 0) return;
    const auto found_m = converted<double>(download_depth(*depth));
    const auto finished_m = finished_surface(found_m, plan.geometry(), options);
    if (casting.outline_m > 0) drawn = drawn_beyond(found_m, finished_m);
    upload_depth(converted<float>(finished_m), finished_depth);
    depth = &finished_depth;
  }

  void tap_slices() const {
    if (!taps.slices) return;
    const SliceVolume& shown = complete ? *complete : *incoming;
    VolumeSlices made{shown.pixels(), shown.sweep, {}};
    for (int f = 0; f < factory.geometry().frames(); ++f) {
      made.slices.push_back(shown.download_slice(f));
    }
    taps.slices(made);
  }

  /// Lets a tap replace z. Returns the time of that, none if z stays.
  std::optional<PassTime> tap_depth() {
    if (!taps.depth) return std::nullopt;
    const PassTime time = timed("correction", &Pipeline::replace_depth);
    return depth == &replaced_depth ? std::optional(time) : std::nullopt;
  }

  void replace_depth() {
    surface_shader.filter(*depth);
    std::optional<Image<float>> other =
        taps.depth({download_depth(ray_caster.depth()),
                    download_depth(*depth),
                    download_depth(surface_shader.filtered_depth())});
    if (!other) return;
    const Extent& extent = depth->extent();
    if (other->width != extent.width || other->height != extent.height) {
      throw std::invalid_argument("RenderTaps::depth: " + std::to_string(other->width) + " x " +
                                  std::to_string(other->height) + " pixels for a picture of " +
                                  std::to_string(extent.width) + " x " +
                                  std::to_string(extent.height));
    }
    upload_depth(*std::move(other), replaced_depth);
    depth = &replaced_depth;
  }

  /// Pass 3, section 3.3: z-buffer, and with ShadingBase::rendered the volume picture, to shaded
  /// surface.
  void shade_surface() { surface_shader.shade(*depth, ray_caster.color()); }

  /// Pass 4, section 3.4: shaded surface to smoothed picture.
  void smooth_picture() { smoother.smooth(surface_shader.surface()); }

  void download(Picture& picture) const {
    picture.surface = download_rgb(smoother.smoothed());
    picture.volume = download_rgb(ray_caster.color());
    picture.depth_m = download_depth(*depth);
    if (depth != &replaced_depth) picture.drawn = drawn;
    picture.filtered_depth_m = download_depth(surface_shader.filtered_depth());
    picture.levels = complete ? complete_levels : incoming_levels;
    check_gl("reading the picture");
  }

  IncidenceCorrection make_incidence(const RenderOptions& given) {
    if (!IncidenceCorrection::acts(given)) return {};
    return {factory.geometry(), beam_widths(), given};
  }

  RayCaster make_ray_caster() const { return {factory.geometry(), options, *incoming}; }

  /// Passes 2 to 4 for other settings, with the slices that are there.
  void set_options(const RenderOptions& given) {
    RayCaster new_ray_caster(factory.geometry(), given, *incoming);
    IncidenceCorrection new_incidence = make_incidence(given);
    SurfaceShader new_shader(given);
    Smoother new_smoother(given.smoothing, given.ray_casting.image_size, given.pipeline.mode);
    options = given;
    has_cast = false;
    ray_caster = std::move(new_ray_caster);
    incidence = std::move(new_incidence);
    surface_shader = std::move(new_shader);
    smoother = std::move(new_smoother);
    set_options_of(*incoming, incoming_levels);
    if (complete) set_options_of(*complete, complete_levels);
  }

  /// Passes 3 and 4 for other settings.
  void set_shading(const RenderOptions& given) {
    Smoother new_smoother(given.smoothing, given.ray_casting.image_size, given.pipeline.mode);
    surface_shader.set_shading(given);
    smoother = std::move(new_smoother);
    options = given;
  }

  void set_options_of(SliceVolume& volume, const std::optional<SurfaceLevels>& levels) const {
    volume.set_options(options);
    if (!levels) return;
    volume.set_level(
        detection_level({levels->fluid, levels->tissue, levels->separate}, options.ray_casting));
  }

  void set_view() {
    has_cast = false;
    incoming->set_view(options);
    if (complete) complete->set_view(options);
    incidence.set_view(options);
    ray_caster.set_view(options);  // the light turns with the viewer: pass 3 does not change
  }

  /// Pass 1 for the new frames.
  PassTime update() {
    if (!std::exchange(has_new_frames, false)) return {kScanConversion, 0, 0};
    PassTime time = timed(kScanConversion, &Pipeline::convert_frames);
    scan_conversion.ms += time.ms;
    if (time.gpu_ms >= 0) {
      scan_conversion.gpu_ms = std::max(scan_conversion.gpu_ms, 0.0) + time.gpu_ms;
    }
    for (const auto& [fetch, count] : time.fetches) scan_conversion.fetches[fetch] += count;
    return time;
  }

  PassTime timed(const char* name, void (Pipeline::*pass)()) {
    PassTime time{name};
    timer.begin();
    try {
      (this->*pass)();
    } catch (...) {
      timer.end(time);
      throw;
    }
    timer.end(time);
    if (FetchCounter* counter = FetchCounter::current()) time.fetches = counter->take();
    return time;
  }

  GlContext& context;
  hw::AcquisitionPlan plan;
  RenderOptions options;
  SliceVolumeFactory factory;
  Reconstruction reconstruction;
  FrameStore frames;
  std::unique_ptr<SliceVolume> incoming;  ///< the volume that new frames belong to
  std::unique_ptr<SliceVolume> complete;  ///< the last complete one; null: `incoming` is shown
  std::optional<SurfaceLevels> incoming_levels, complete_levels;  ///< none: not measured
  RayCaster ray_caster;
  std::optional<hw::BeamWidths> beam;  ///< once a correction or a level has needed it
  IncidenceCorrection incidence;
  const Texture* depth = nullptr;  ///< z that pass 3 reads
  Texture finished_depth;          ///< of finish_outline(); empty before it has changed any
  Image<std::uint8_t> drawn;       ///< Picture::drawn
  Texture replaced_depth;          ///< of a tap; empty before it replaces any
  SurfaceShader surface_shader;
  Smoother smoother;
  RenderTaps taps;
  PassTimer timer;
  PassTime scan_conversion{kScanConversion};  ///< since the last picture
  bool has_new_frames = false;                ///< since the last update()
  bool has_cast = false;                      ///< z and volume picture are those of now
};

Renderer::Renderer(GlContext& context,
                   const hw::AcquisitionPlan& plan,
                   const RenderOptions& options) {
  validate(options);
  context.make_current();
  const HostState host;
  pipeline_ = std::make_unique<Pipeline>(context, plan, options);
}

Renderer::~Renderer() {
  std::optional<ForgetNames> forget;
  try {
    pipeline_->context.make_current();
  } catch (const std::exception&) {
    forget.emplace();
  }
  pipeline_.reset();
}

void Renderer::compile() {
  pipeline_->context.make_current();
  const HostState host;
  pipeline_->timed("compiling", &Pipeline::compile);
}

std::future<void> Renderer::compile_in_background() {
  struct ReleaseAtEnd {
    GlContext& context;
    ~ReleaseAtEnd() { context.release(); }
  };
  pipeline_->context.release();
  return std::async(std::launch::async, [this] {
    const ReleaseAtEnd hand_over{pipeline_->context};
    compile();
  });
}

void Renderer::add_frame(int frame_index, const hw::PolarFrame& frame) {
  pipeline_->frames.put(frame_index, frame);
  pipeline_->incoming->sweep = sweep_of(frame);
  pipeline_->has_new_frames = true;
}

void Renderer::add_volume(const hw::PolarVolume& volume) {
  check_log_compressed(volume);
  int index = 0;
  for (const hw::PolarFrame& frame : volume.frames()) add_frame(index++, frame);
}

PassTime Renderer::update() {
  if (!pipeline_->has_new_frames) return {kScanConversion, 0, 0};
  pipeline_->context.make_current();
  const HostState host;
  return pipeline_->update();
}

Picture Renderer::render(Rays rays) {
  Pipeline& p = *pipeline_;
  p.context.make_current();
  const HostState host;
  p.update();
  Picture picture;
  picture.passes.push_back(std::exchange(p.scan_conversion, {kScanConversion}));
  p.tap_slices();
  if (rays == Rays::cast || !p.has_cast) {
    picture.passes.push_back(p.timed("ray_casting", &Pipeline::cast_rays));
  }
  if (auto correction = p.tap_depth()) picture.passes.push_back(*std::move(correction));
  picture.passes.push_back(p.timed("surface_shading", &Pipeline::shade_surface));
  if (p.taps.shaded) p.taps.shaded(download_rgb(p.surface_shader.surface()));
  picture.passes.push_back(p.timed("smoothing", &Pipeline::smooth_picture));
  p.download(picture);
  if (p.taps.smoothed) p.taps.smoothed(picture.surface);
  return picture;
}

void Renderer::set_taps(RenderTaps taps) {
  pipeline_->taps = std::move(taps);
  pipeline_->has_cast = false;
}

bool Renderer::keeps_slices(const RenderOptions& options) const {
  return same_slices(options, pipeline_->options);
}

bool Renderer::has_rays() const {
  return pipeline_->has_cast;
}

void Renderer::set_options(const RenderOptions& options) {
  Pipeline& p = *pipeline_;
  validate(options);
  if (!keeps_slices(options)) {
    throw std::invalid_argument("Renderer::set_options: pass 1 would not make the same slices");
  }
  if (options == p.options) return;
  p.context.make_current();
  const HostState host;
  RenderOptions turned = p.options;
  turned.view.yaw_rad = options.view.yaw_rad;
  turned.view.pitch_rad = options.view.pitch_rad;
  turned.view.roll_rad = options.view.roll_rad;
  turned.view.flip = options.view.flip;
  RenderOptions shaded = p.options;
  shaded.shading = options.shading;
  shaded.smoothing = options.smoothing;
  if (options == turned) {
    p.options = options;
    p.set_view();
  } else if (options == shaded) {
    p.set_shading(options);
  } else {
    p.set_options(options);
  }
}

void Renderer::set_view(const ViewOptions& view) {
  RenderOptions options = pipeline_->options;
  options.view = view;
  set_options(options);
}

Picture render_volume(GlContext& context,
                      const hw::PolarVolume& volume,
                      const RenderOptions& options) {
  Renderer renderer(context, volume.plan(), options);
  renderer.add_volume(volume);
  return renderer.render();
}

}  // namespace wobblebench::render
