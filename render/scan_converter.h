// Pass 1: each frame's sticks to one Cartesian, filtered slice of the volume texture.
#pragma once

#include "hw/polar_volume.h"
#include "render/gl_program.h"
#include "render/options.h"
#include "render/slice_geometry.h"

namespace wobblebench::render {

/// Paper section 3.1. The LUT is made once, on the CPU, for the plan.
class ScanConverter {
 public:
  /// Throws std::runtime_error when frames or slices are beyond the driver's limits.
  ScanConverter(const hw::AcquisitionPlan& plan, const ScanConversionOptions& options);

  /// Writes the frame's slice. Samples are clamped to [0, 1]; NaN and infinities become 0, so that
  /// a bad sample reaches no further than its own neighbourhood. Throws std::out_of_range for an
  /// index outside the plan, std::invalid_argument for a frame of another size.
  void convert(int frame_index, const hw::PolarFrame& frame);

  /// slice_size x slice_size x frames; zero where no frame has been written.
  const Texture& slices() const { return slices_; }
  const SliceGeometry& geometry() const { return geometry_; }

 private:
  void upload(const std::vector<float>& samples);

  SliceGeometry geometry_;
  TextureFormat format_;
  Texture polar_table_, frame_, unfiltered_, slices_;
  Framebuffer unfiltered_target_;
  FragmentProgram scan_convert_, filter_;
};

/// What pass 1 makes of a sample before anything else: within [0, 1], 0 for NaN and infinities.
float clean_sample(float sample);

}  // namespace wobblebench::render
