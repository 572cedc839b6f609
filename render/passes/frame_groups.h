// Mode fast: polar frames on the GPU, in groups of four.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "hw/probe/acquisition_plan.h"
#include "render/geometry/slice_geometry.h"
#include "render/gl/objects.h"
#include "render/options.h"
#include "render/reconstruction/frame_store.h"

namespace wobblebench::render {

/// Slices of a group, one in each channel of a texel.
inline constexpr int kGroupSlices = 4;

/// The part of a frame that some pixels are made of.
struct FrameWindow {
  int line = 0, lines = 0;      ///< first stick, and number of them
  int sample = 0, samples = 0;  ///< likewise of each stick
};

/// What bilinear fetches at the entries of a polar table (make_polar_table()) read; a single sample
/// if no pixel holds data.
FrameWindow window_of(const std::vector<float>& polar_table, const hw::AcquisitionOptions& scan);

/// The entries of a polar table, counted from the window's first stick and sample.
std::vector<float> within_window(std::vector<float> polar_table, const FrameWindow& window);

/// A window of kGroupsPerBatch groups of frames (samples x lines), with linear filtering; 16-bit
/// fixed point, or float where slices are float, so that the upload loses no precision that slices
/// would keep.
class FrameGroups {
 public:
  /// `samples`: of a stick, whole.
  FrameGroups(const FrameWindow& window, int samples, TextureFormat format);

  /// For each slice of a group the frames, of samples in [0, 1], that are added; none: zeros.
  using Slices = std::array<std::vector<WeightedFrame>, kGroupSlices>;
  void upload(int group, const Slices& slices);

  const Texture& texture() const { return texture_; }

 private:
  template <class Texel>
  void pack_and_upload(int group, const Slices& slices, std::vector<Texel>& packed);

  FrameWindow window_;
  std::size_t samples_;  ///< of a stick, whole
  Texture texture_;
  bool in_floats_;
  std::vector<float> floats_;  ///< [line][sample][slice] of the window
  std::vector<std::uint16_t> fixed_point_;
};

}  // namespace wobblebench::render
