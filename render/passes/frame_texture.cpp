#include "render/passes/frame_texture.h"

#include <algorithm>
#include <stdexcept>

namespace wobblebench::render {

SliceFormats slice_formats(TextureFormat format) {
  switch (format) {
    case TextureFormat::r8:
      return {TexelFormat::r8, TexelFormat::rg8, TexelFormat::rgba8};
    case TextureFormat::r16:
      return {TexelFormat::r16, TexelFormat::rg16, TexelFormat::rgba16};
    case TextureFormat::r32f:
      return {TexelFormat::r32f, TexelFormat::rg32f, TexelFormat::rgba32f};
  }
  throw std::logic_error("TextureFormat: no such format");
}

FrameTexture::FrameTexture(const hw::AcquisitionPlan& plan, TextureFormat format)
    : in_floats_(format == TextureFormat::r32f) {
  const hw::AcquisitionOptions& acquisition = plan.acquisition();
  texture_ = Texture("polar frame",
                     in_floats_ ? TexelFormat::r32f : TexelFormat::r16,
                     {acquisition.samples_per_stick, acquisition.sticks_per_frame},
                     TextureFilter::nearest);
}

FrameTexture::FrameTexture(const hw::AcquisitionPlan& plan, TextureFormat format, int groups)
    : in_floats_(format == TextureFormat::r32f) {
  const hw::AcquisitionOptions& acquisition = plan.acquisition();
  texture_ = Texture("groups of polar frames",
                     in_floats_ ? TexelFormat::rgba32f : TexelFormat::rgba16,
                     {acquisition.samples_per_stick, acquisition.sticks_per_frame, groups, true},
                     TextureFilter::linear);
}

const std::vector<std::uint16_t>& FrameTexture::fixed_point(const std::vector<float>& samples) {
  fixed_point_.resize(samples.size());
  std::transform(samples.begin(), samples.end(), fixed_point_.begin(), [](float sample) {
    // Rounds to nearest, as samples are not negative; vectorised, unlike lround.
    const float scaled = sample * 65535.0f + 0.5f;
    return static_cast<std::uint16_t>(scaled);
  });
  return fixed_point_;
}

void FrameTexture::upload(const std::vector<float>& samples) {
  in_floats_ ? texture_.upload(samples) : texture_.upload(fixed_point(samples));
}

void FrameTexture::upload_group(int group, const std::vector<float>& samples) {
  in_floats_ ? texture_.upload_layer(group, samples)
             : texture_.upload_layer(group, fixed_point(samples));
}

}  // namespace wobblebench::render
