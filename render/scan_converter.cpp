#include "render/scan_converter.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

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

TexelFormat slice_format(TextureFormat format) {
  switch (format) {
    case TextureFormat::r8:
      return TexelFormat::r8;
    case TextureFormat::r16:
      return TexelFormat::r16;
    case TextureFormat::r32f:
      return TexelFormat::r32f;
  }
  throw std::logic_error("TextureFormat: no such format");
}

/// Sticks lose nothing on their way up that the slices would keep.
TexelFormat frame_format(TextureFormat format) {
  return format == TextureFormat::r32f ? TexelFormat::r32f : TexelFormat::r16;
}

}  // namespace

float clean_sample(float sample) {
  return std::isfinite(sample) ? std::clamp(sample, 0.0f, 1.0f) : 0.0f;
}

ScanConverter::ScanConverter(const hw::AcquisitionPlan& plan, const ScanConversionOptions& options)
    : geometry_(plan, options.slice_size), format_(options.format) {
  const int size = options.slice_size;
  const hw::AcquisitionOptions& acquisition = plan.acquisition();
  slices_ = Texture("scan_conversion.slice_size = " + std::to_string(size) + ", " +
                        std::to_string(acquisition.frames_per_volume) + " frames",
                    slice_format(options.format),
                    {size, size, acquisition.frames_per_volume},
                    TextureFilter::linear);
  frame_ = Texture("polar frame",
                   frame_format(options.format),
                   {acquisition.samples_per_stick, acquisition.sticks_per_frame},
                   TextureFilter::nearest);
  polar_table_ =
      Texture("scan-conversion LUT", TexelFormat::rgb32f, {size, size}, TextureFilter::nearest);
  polar_table_.upload(make_polar_table(geometry_));
  unfiltered_ =
      Texture("unfiltered slice", TexelFormat::r32f, {size, size}, TextureFilter::nearest);
  unfiltered_target_ = Framebuffer({&unfiltered_});
  scan_convert_ = FragmentProgram({"scan_convert.frag.glsl"},
                                  Defines()
                                      .add("BIND_POLAR_TABLE", scan_convert::kPolarTable)
                                      .add("BIND_FRAME", scan_convert::kFrame)
                                      .add("EMPTY", kEmpty));
  filter_ = FragmentProgram({"slice_filter.frag.glsl"},
                            Defines()
                                .add("BIND_SLICE", slice_filter::kSlice)
                                .add("HALF_FILTER", options.filter_size / 2));
  check_gl("scan conversion: setting up");
}

void ScanConverter::upload(const std::vector<float>& samples) {
  std::vector<float> clean(samples.size());
  std::transform(samples.begin(), samples.end(), clean.begin(), clean_sample);
  if (format_ == TextureFormat::r32f) {
    frame_.upload(clean);
    return;
  }
  std::vector<std::uint16_t> fixed(clean.size());
  std::transform(clean.begin(), clean.end(), fixed.begin(), [](float sample) {
    return static_cast<std::uint16_t>(std::lround(sample * 65535.0f));
  });
  frame_.upload(fixed);
}

void ScanConverter::convert(int frame_index, const hw::PolarFrame& frame) {
  if (frame_index < 0 || frame_index >= geometry_.frames()) {
    throw std::out_of_range("frame " + std::to_string(frame_index) + " of " +
                            std::to_string(geometry_.frames()));
  }
  const std::size_t expected = static_cast<std::size_t>(frame_.extent().width) *
                               static_cast<std::size_t>(frame_.extent().height);
  if (frame.samples.size() != expected) {
    throw std::invalid_argument("a frame of " + std::to_string(frame.samples.size()) +
                                " samples; the plan has " + std::to_string(expected));
  }
  upload(frame.samples);
  scan_convert_.draw(unfiltered_target_,
                     {{scan_convert::kPolarTable, &polar_table_}, {scan_convert::kFrame, &frame_}});
  filter_.draw(Framebuffer::of_layer(slices_, frame_index), {{slice_filter::kSlice, &unfiltered_}});
  check_gl("scan conversion");
}

}  // namespace wobblebench::render
