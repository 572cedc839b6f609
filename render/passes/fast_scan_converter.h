// Pass 1, mode fast: scan conversion of four frames per texel, for the pixels that rays read.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "render/geometry/slice_geometry.h"
#include "render/gl/program.h"
#include "render/options.h"
#include "render/passes/frame_groups.h"
#include "render/passes/scan_converter.h"
#include "render/reconstruction/frame_store.h"

namespace wobblebench::render {

/// The pixels of a slice that rays read.
Region pixels_that_rays_read(const SliceGeometry& geometry, const RenderOptions& options);

/// The pixels that rays read, of all slices: layer k holds slice k in red and slice k + 1 in green,
/// so that one bilinear fetch reads both neighbours of a sample. On a CPU that costs half as much
/// as a trilinear fetch.
class SlicePairs {
 public:
  /// Throws std::runtime_error when frames or slices are beyond the driver's limits.
  SlicePairs(const SliceGeometry& geometry, const RenderOptions& options);

  const Texture& texture() const { return texture_; }
  /// The pixels of a slice that are stored.
  const Region& region() const { return region_; }

 private:
  Region region_;
  Texture texture_;
};

/// Called for each batch of finished groups: the four channels of layer i of `slices` hold the
/// slices of groups[i], in the pixels and the format of SlicePairs.
using GroupsCallback =
    std::function<void(const Texture& slices, const std::vector<LayerGroup>& groups)>;

/// Scan conversion, then the filter within a slice (slice_weights()) along rows and columns.
class FastScanConverter {
 public:
  FastScanConverter(const SliceGeometry& geometry,
                    const hw::AcquisitionPlan& plan,
                    const RenderOptions& options);

  /// Makes these layers of `slices`, in ascending order. On a CPU four slices, which give three
  /// layers, cost hardly more than one.
  void convert(const std::vector<int>& layers,
               const FrameStore& store,
               const SlicePairs& slices,
               const GroupsCallback& on_groups);

 private:
  void make_programs(const std::vector<double>& weights);
  void convert_batch(const std::vector<LayerGroup>& batch,
                     const FrameStore& store,
                     const SlicePairs& slices);
  void upload(const std::vector<LayerGroup>& batch, const FrameStore& store);

  int frames_;
  bool single_tap_ = false;  ///< pixels that hold data are not filtered
  int border_ = 0;           ///< pixels around the region that the filter reads
  std::optional<FrameGroups> frame_groups_;
  Texture polar_table_, normaliser_, unfiltered_, rows_, made_;
  Framebuffer unfiltered_target_, rows_target_;
  FragmentProgram scan_convert_, along_rows_, along_columns_;
};

}  // namespace wobblebench::render
