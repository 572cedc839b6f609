// Textures of polar frames; pass 1, mode plain: scan conversion of each frame to a filtered slice
// of the volume texture.
#pragma once

#include <cstdint>
#include <vector>

#include "hw/probe/acquisition_plan.h"
#include "render/geometry/slice_geometry.h"
#include "render/gl/objects.h"
#include "render/gl/program.h"
#include "render/options.h"

namespace wobblebench::render {

/// Texel formats of one slice, a pair of neighbours, or a group of four.
struct SliceFormats {
  TexelFormat one, pair, group;
};
SliceFormats slice_formats(TextureFormat format);

/// A sample in [0, 1] as 16-bit fixed point, to nearest; vectorised, unlike lround.
inline std::uint16_t to_fixed_point(float sample) {
  const float scaled = sample * 65535.0f + 0.5f;
  return static_cast<std::uint16_t>(scaled);
}

/// A frame (samples x lines); 16-bit fixed point, or float where slices are float, so that the
/// upload loses no precision that slices would keep.
class FrameTexture {
 public:
  FrameTexture(const hw::AcquisitionPlan& plan, TextureFormat format);

  /// Samples in [0, 1], stick after stick.
  void upload(const std::vector<float>& samples);

  const Texture& texture() const { return texture_; }

 private:
  const std::vector<std::uint16_t>& fixed_point(const std::vector<float>& samples);

  Texture texture_;
  bool in_floats_;
  std::vector<std::uint16_t> fixed_point_;
};

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
