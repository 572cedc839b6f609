// Pass 1, mode fast: several pairs of frames at once, and only what rays read.
#pragma once

#include <vector>

#include "render/frame_store.h"
#include "render/frame_texture.h"
#include "render/gl_program.h"
#include "render/options.h"
#include "render/slice_geometry.h"

namespace wobblebench::render {

/// The pixels that rays read, of all slices: layer k holds slice k in red and slice k + 1 in green,
/// so that one bilinear fetch reads both sides of a sample. On a CPU that costs half of what a
/// trilinear fetch does.
class SlicePairs {
 public:
  /// Throws std::runtime_error when frames or slices are beyond the driver's limits.
  SlicePairs(const SliceGeometry& geometry, const RenderOptions& options);

  const Texture& texture() const { return texture_; }
  const Framebuffer& target() const { return target_; }
  /// The pixels of a slice that there are.
  const Region& region() const { return region_; }

 private:
  Region region_;
  Texture texture_;
  Framebuffer target_;
};

/// Scan conversion, then the filter within a slice (slice_weights()), one axis after the other.
class FastScanConverter {
 public:
  FastScanConverter(const SliceGeometry& geometry,
                    const hw::AcquisitionPlan& plan,
                    const RenderOptions& options);

  /// Makes these layers: slices k and k + 1 of each. A pair of frames costs a CPU hardly more than
  /// one of them.
  void convert(const std::vector<int>& layers, FrameStore& store, const SlicePairs& slices);

 private:
  void upload(const std::vector<int>& layers, FrameStore& store);
  void make_programs(const std::vector<double>& weights, bool lone_tap);

  int frames_;
  std::vector<float> pair_;
  int border_;  ///< pixels around the region that the filter reads
  FrameTexture frame_texture_;
  Texture polar_table_, normaliser_, unfiltered_, rows_;
  Framebuffer unfiltered_target_, rows_target_;
  FragmentProgram scan_convert_, along_rows_, along_columns_;
};

}  // namespace wobblebench::render
