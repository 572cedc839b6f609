// Textures of polar frames.
#pragma once

#include <cstdint>
#include <vector>

#include "hw/probe/acquisition_plan.h"
#include "render/gl/objects.h"
#include "render/options.h"

namespace wobblebench::render {

/// Texel formats of one slice, a pair of neighbours, or a group of four.
struct SliceFormats {
  TexelFormat one, pair, group;
};
SliceFormats slice_formats(TextureFormat format);

/// A frame (samples x lines), or a batch of groups of four frames; 16-bit fixed point, or float
/// where slices are float, so that the upload loses no precision that slices would keep.
class FrameTexture {
 public:
  /// For one frame.
  FrameTexture(const hw::AcquisitionPlan& plan, TextureFormat format);
  /// For an array of groups, with linear filtering.
  FrameTexture(const hw::AcquisitionPlan& plan, TextureFormat format, int groups);

  /// Samples in [0, 1], stick after stick.
  void upload(const std::vector<float>& samples);
  /// Samples in [0, 1] of four frames, interleaved.
  void upload_group(int group, const std::vector<float>& samples);

  const Texture& texture() const { return texture_; }

 private:
  const std::vector<std::uint16_t>& fixed_point(const std::vector<float>& samples);

  Texture texture_;
  bool in_floats_;
  std::vector<std::uint16_t> fixed_point_;
};

}  // namespace wobblebench::render
