#include "render/passes/scan_converter.h"

#include <algorithm>
#include <stdexcept>
#include <string>

#include "render/geometry/ray_sampling.h"

namespace wobblebench::render {
namespace {

namespace scan_convert {
enum Bindings { kPolarTable, kFrame };
}
namespace slice_filter {
enum Bindings { kSlice };
}

/// Value of a pixel without data in the unfiltered slice.
constexpr int kEmpty = -1;

}  // namespace

Slices::Slices(const SliceGeometry& geometry, const ScanConversionOptions& options) {
  const int size = options.slice_size, frames = geometry.frames();
  texture_ = Texture("scan_conversion.slice_size = " + std::to_string(size) + ", " +
                         std::to_string(frames) + " frames",
                     slice_formats(options.format).one,
                     {size, size, frames},
                     TextureFilter::linear);
  for (int frame = 0; frame < frames; ++frame) {
    layers_.push_back(Framebuffer::of_layers({{&texture_, frame}}));
  }
}

ScanConverter::ScanConverter(const SliceGeometry& geometry,
                             const hw::AcquisitionPlan& plan,
                             const RenderOptions& options)
    : frame_(plan, options.scan_conversion.format) {
  const int size = geometry.slice_size();
  polar_table_ =
      Texture("scan-conversion LUT", TexelFormat::rgb32f, {size, size}, TextureFilter::nearest);
  polar_table_.upload(make_polar_table(geometry, {0, 0, size, size}));
  unfiltered_ =
      Texture("unfiltered slice", TexelFormat::r32f, {size, size}, TextureFilter::nearest);
  unfiltered_target_ = Framebuffer({&unfiltered_});
  scan_convert_ = FragmentProgram({"scan_convert.frag.glsl"},
                                  Defines()
                                      .add("BIND_POLAR_TABLE", scan_convert::kPolarTable)
                                      .add("BIND_FRAME", scan_convert::kFrame)
                                      .add("EMPTY", kEmpty));
  const std::vector<double> weights = slice_weights(options);
  filter_ = FragmentProgram({"slice_filter.frag.glsl"},
                            Defines()
                                .add("BIND_SLICE", slice_filter::kSlice)
                                .add("TAPS", static_cast<int>(weights.size()))
                                .add("BOX", frame_weights(options.ray_casting).size() == 1));
  filter_.set("weights", weights);
  check_gl("scan conversion: setting up");
}

void ScanConverter::convert(const std::vector<float>& samples, const Framebuffer& slice) {
  frame_.upload(samples);
  scan_convert_.draw(
      unfiltered_target_,
      {{scan_convert::kPolarTable, &polar_table_}, {scan_convert::kFrame, &frame_.texture()}});
  filter_.draw(slice, {{slice_filter::kSlice, &unfiltered_}});
  check_gl("scan conversion");
}

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

const std::vector<std::uint16_t>& FrameTexture::fixed_point(const std::vector<float>& samples) {
  fixed_point_.resize(samples.size());
  std::transform(samples.begin(), samples.end(), fixed_point_.begin(), to_fixed_point);
  return fixed_point_;
}

void FrameTexture::upload(const std::vector<float>& samples) {
  in_floats_ ? texture_.upload(samples) : texture_.upload(fixed_point(samples));
}

}  // namespace wobblebench::render
