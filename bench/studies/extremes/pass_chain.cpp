#include "bench/studies/extremes/pass_chain.h"

#include <algorithm>
#include <memory>
#include <numeric>
#include <utility>

#include "render/geometry/sample.h"
#include "render/passes/incidence_correction.h"
#include "render/passes/ray_caster.h"
#include "render/passes/slice_volume.h"
#include "render/passes/smoother.h"
#include "render/passes/surface_shader.h"
#include "render/reconstruction/reconstruction.h"

namespace wobblebench::bench {

namespace {

Image<float> depths(const render::Texture& texture) {
  Image<float> image(texture.extent().width, texture.extent().height);
  image.pixels = texture.download();
  for (float& z : image.pixels) {
    if (z < 0) z = kNoSurface;
  }
  return image;
}

Image<glm::vec3> colours(const render::Texture& texture) {
  Image<glm::vec3> image(texture.extent().width, texture.extent().height);
  const std::vector<float> rgba = texture.download();
  for (std::size_t i = 0; i < image.pixels.size(); ++i) {
    image.pixels[i] = {rgba[4 * i], rgba[4 * i + 1], rgba[4 * i + 2]};
  }
  return image;
}

/// Slices of a texture with one slice a layer, or slices k and k + 1 in layer k.
std::vector<Image<float>> slices_of(const render::SliceVolume& made, int frames, bool pairs) {
  const render::Region region = made.pixels();
  const std::vector<float> texels = made.slices().download();
  const auto channels = static_cast<std::size_t>(pairs ? 2 : 1);
  const auto size =
      static_cast<std::size_t>(region.columns) * static_cast<std::size_t>(region.rows);
  std::vector<Image<float>> slices;
  for (int frame = 0; frame < frames; ++frame) {
    const int layer = pairs ? std::min(frame, std::max(frames - 2, 0)) : frame;
    const auto channel = static_cast<std::size_t>(layer != frame);
    Image<float>& slice = slices.emplace_back(region.columns, region.rows);
    for (std::size_t i = 0; i < size; ++i) {
      const std::size_t texel = static_cast<std::size_t>(layer) * size + i;
      slice.pixels[i] = texels[channels * texel + channel];
    }
  }
  return slices;
}

/// What is before pass 1: sticks, and levels where they are needed.
render::EchoLevels reconstruct(const hw::PolarVolume& volume,
                               const render::RenderOptions& options,
                               render::FrameStore& frames,
                               render::SliceVolume& made) {
  render::Reconstruction reconstruction(volume.plan(), options);
  const int count = static_cast<int>(volume.frames().size());
  for (int f = 0; f < count; ++f) reconstruction.put(f, volume.frame(f));
  render::EchoLevels levels;
  if (needs_levels(options)) {
    levels = reconstruction.levels();
    made.set_level(detection_level(levels, options.ray_casting));
  }
  if (reconstruction.aligns()) {
    int f = 0;
    for (auto& samples : reconstruction.aligned_frames(levels)) frames.put(f++, std::move(samples));
  } else {
    for (int f = 0; f < count; ++f) frames.put(f, reconstruction.frame(f));
  }
  return levels;
}

}  // namespace

PassPictures run_passes(const hw::PolarVolume& volume, const render::RenderOptions& options) {
  validate(options);
  render::check_log_compressed(volume);
  const render::SliceVolumeFactory factory(volume.plan(), options);
  const auto made = factory.make();
  render::FrameStore frames = factory.make_frame_store();
  PassPictures pictures;
  made->sweep = volume.plan().sweep_direction(volume.volume_index());
  pictures.levels = reconstruct(volume, options, frames, *made);
  made->make_layers(frames.take_complete(), frames);
  const bool pairs = options.pipeline.mode == render::PipelineMode::fast;
  pictures.pixels = made->pixels();
  pictures.slices = slices_of(*made, factory.geometry().frames(), pairs);

  render::RayCaster caster(factory.geometry(), options, *made);
  caster.cast(*made);
  pictures.cast_m = depths(caster.depth());
  pictures.volume = colours(caster.color());
  render::IncidenceCorrection incidence(factory.geometry(), options);
  const render::Texture& corrected = incidence.correct(caster.depth());
  pictures.corrected_m = depths(corrected);
  render::SurfaceShader shader(options);
  shader.shade(corrected, caster.color());
  pictures.filtered_m = depths(shader.filtered_depth());
  pictures.shaded = colours(shader.surface());
  render::Smoother smoother(
      options.smoothing, options.ray_casting.image_size, options.pipeline.mode);
  smoother.smooth(shader.surface());
  pictures.smoothed = colours(smoother.smoothed());
  return pictures;
}

}  // namespace wobblebench::bench
