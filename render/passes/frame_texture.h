// Polar frames on the GPU.
#pragma once

#include <cstdint>
#include <vector>

#include "hw/probe/acquisition_plan.h"
#include "render/gl/objects.h"
#include "render/options.h"

namespace wobblebench::render {

/// Slices a texel: one, two neighbours, or a group of four.
struct SliceFormats {
  TexelFormat one, pair, group;
};
SliceFormats slice_formats(TextureFormat format);

/// A frame (samples x lines) or a batch of groups of four frames, in 16 bits, or as floats where
/// slices are: sticks lose nothing on their way up that slices would keep.
class FrameTexture {
 public:
  /// One frame.
  FrameTexture(const hw::AcquisitionPlan& plan, TextureFormat format);
  /// An array of groups, for linear fetches.
  FrameTexture(const hw::AcquisitionPlan& plan, TextureFormat format, int groups);

  /// Samples in [0, 1], stick after stick.
  void upload(const std::vector<float>& samples);
  /// Those of four frames in turn.
  void upload_group(int group, const std::vector<float>& samples);

  const Texture& texture() const { return texture_; }

 private:
  const std::vector<std::uint16_t>& fixed_point(const std::vector<float>& samples);

  Texture texture_;
  bool in_floats_;
  std::vector<std::uint16_t> fixed_point_;
};

}  // namespace wobblebench::render
