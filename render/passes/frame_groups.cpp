#include "render/passes/frame_groups.h"

#include <algorithm>
#include <cmath>
#include <type_traits>

#include "base/parallel.h"
#include "render/passes/scan_converter.h"

namespace wobblebench::render {
namespace {

constexpr std::size_t kTableChannels = 3;  ///< line, sample, flag

/// First index and number of those that linear fetches between two positions read, out of `all`.
std::array<int, 2> indices_between(float low, float high, int all) {
  const int first = std::clamp(static_cast<int>(std::floor(low)), 0, all - 1);
  const int last = std::clamp(static_cast<int>(std::floor(high)) + 1, first, all - 1);
  return {first, last - first + 1};
}

template <class Texel>
Texel to_texel(float sample) {
  if constexpr (std::is_same_v<Texel, float>) {
    return sample;
  } else {
    return to_fixed_point(sample);
  }
}

/// The weighted sum of a part of the frames' sticks, from sample `begin` of the frames on.
void add_up(const std::vector<WeightedFrame>& frames, std::size_t begin, std::vector<float>& sum) {
  std::fill(sum.begin(), sum.end(), 0.0f);
  for (const auto& [samples, share] : frames) {
    const float* stick = samples->data() + begin;
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += share * stick[i];
  }
}

/// Interleaves four sticks.
template <class Texel>
void interleave(const std::array<std::vector<float>, kGroupSlices>& sticks, Texel* texels) {
  const float *a = sticks[0].data(), *b = sticks[1].data(), *c = sticks[2].data(),
              *d = sticks[3].data();
  for (std::size_t i = 0; i < sticks[0].size(); ++i) {
    texels[4 * i] = to_texel<Texel>(a[i]);
    texels[4 * i + 1] = to_texel<Texel>(b[i]);
    texels[4 * i + 2] = to_texel<Texel>(c[i]);
    texels[4 * i + 3] = to_texel<Texel>(d[i]);
  }
}

}  // namespace

FrameWindow window_of(const std::vector<float>& polar_table, const hw::AcquisitionOptions& scan) {
  bool any = false;
  std::array<float, 2> low{}, high{};
  for (std::size_t i = 0; i < polar_table.size(); i += kTableChannels) {
    if (polar_table[i + 2] == 0.0f) continue;
    for (std::size_t axis = 0; axis < 2; ++axis) {
      const float at = polar_table[i + axis];
      low[axis] = any ? std::min(low[axis], at) : at;
      high[axis] = any ? std::max(high[axis], at) : at;
    }
    any = true;
  }
  const auto [line, lines] = indices_between(low[0], high[0], scan.sticks_per_frame);
  const auto [sample, samples] = indices_between(low[1], high[1], scan.samples_per_stick);
  return {line, lines, sample, samples};
}

std::vector<float> within_window(std::vector<float> polar_table, const FrameWindow& window) {
  for (std::size_t i = 0; i < polar_table.size(); i += kTableChannels) {
    if (polar_table[i + 2] == 0.0f) continue;
    polar_table[i] -= static_cast<float>(window.line);
    polar_table[i + 1] -= static_cast<float>(window.sample);
  }
  return polar_table;
}

FrameGroups::FrameGroups(const FrameWindow& window, int samples, TextureFormat format)
    : window_(window),
      samples_(static_cast<std::size_t>(samples)),
      in_floats_(format == TextureFormat::r32f) {
  texture_ = Texture("groups of polar frames",
                     in_floats_ ? TexelFormat::rgba32f : TexelFormat::rgba16,
                     {window.samples, window.lines, kGroupsPerBatch, true},
                     TextureFilter::linear);
}

void FrameGroups::upload(int group, const Slices& slices) {
  in_floats_ ? pack_and_upload(group, slices, floats_)
             : pack_and_upload(group, slices, fixed_point_);
}

template <class Texel>
void FrameGroups::pack_and_upload(int group, const Slices& slices, std::vector<Texel>& packed) {
  const auto samples = static_cast<std::size_t>(window_.samples);
  packed.resize(kGroupSlices * samples * static_cast<std::size_t>(window_.lines));
  parallel_ranges(window_.lines, 0, [&](int first, int last) {
    std::array<std::vector<float>, kGroupSlices> sticks;
    for (auto& stick : sticks) stick.resize(samples);
    for (int row = first; row < last; ++row) {
      const std::size_t begin = static_cast<std::size_t>(window_.line + row) * samples_ +
                                static_cast<std::size_t>(window_.sample);
      for (std::size_t slice = 0; slice < slices.size(); ++slice) {
        add_up(slices[slice], begin, sticks[slice]);
      }
      interleave(sticks, packed.data() + kGroupSlices * samples * static_cast<std::size_t>(row));
    }
  });
  texture_.upload_layer(group, packed);
}

}  // namespace wobblebench::render
