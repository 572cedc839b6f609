// Pass 1, mode plain: scan conversion of each frame to a filtered slice of the volume texture.
#pragma once

#include <vector>

#include "render/geometry/slice_geometry.h"
#include "render/gl/program.h"
#include "render/options.h"
#include "render/passes/frame_texture.h"

namespace wobblebench::render {

/// The volume texture: slice_size x slice_size x frames, initially zero.
class Slices {
 public:
  /// Throws std::runtime_error when frames or slices are beyond the driver's limits.
  Slices(const SliceGeometry& geometry, const ScanConversionOptions& options);

  const Texture& texture() const { return texture_; }
  const Framebuffer& layer(int frame) const { return layers_.at(static_cast<std::size_t>(frame)); }

 private:
  Texture texture_;
  std::vector<Framebuffer> layers_;
};

/// Paper section 3.1, one frame at a time. The LUT is computed once per plan, on the CPU.
class ScanConverter {
 public:
  ScanConverter(const SliceGeometry& geometry,
                const hw::AcquisitionPlan& plan,
                const RenderOptions& options);

  /// Makes a frame's slice from its samples in [0, 1], stick after stick.
  void convert(const std::vector<float>& samples, const Framebuffer& slice);

 private:
  FrameTexture frame_;
  Texture polar_table_, unfiltered_;
  Framebuffer unfiltered_target_;
  FragmentProgram scan_convert_, filter_;
};

}  // namespace wobblebench::render
