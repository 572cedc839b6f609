// How far a pass in float32 and 8 or 16 bits may be from the same in double precision, derived from
// its arithmetic: nothing here is measured on the renderer
// (docs/decisions/0032-bounds-of-the-passes.md). `u` is the unit roundoff of float32, 2^-24. A
// result of k rounded operations is within k u of the greatest intermediate value. An error
// of position, as a fraction of the spacing of samples or pixels, counts by the greatest difference
// between neighbours: of samples a full scale, of pixels that of the reference's slices.
#pragma once

#include "base/image.h"
#include "hw/probe/acquisition_plan.h"
#include "render/camera.h"
#include "render/options.h"
#include "render/reference/reference_passes.h"

namespace wobblebench::bench {

struct PassBounds {
  double slices = 0;      ///< of a slice's pixel, full scales
  double sample = 0;      ///< of a sample that a ray reads, full scales
  double detector = 0;    ///< of what the detector compares with its threshold, full scales
  double position_m = 0;  ///< of a position in the probe frame
  double cone_m = 0;      ///< of a ray's sample against the cone: position and motor angle
  double depth_m = 0;     ///< of z beside the detector's
};

/// Infinite where a scan's motor axis lies among the samples of a ray: there the
/// frame index changes without bound.
PassBounds pass_bounds(const hw::AcquisitionPlan& plan,
                       const render::reference::SliceStack& slices,
                       const render::RenderOptions& options);

/// Of the blended picture of pass 2, full scales, for each pixel. Samples are exchanged for wrong
/// ones one after the other along the reference's ray: each changes the picture by the light that
/// reaches it times the error of its opacity and grey level.
Image<double> blend_bounds(const render::reference::SliceStack& slices,
                           const render::RenderOptions& options,
                           const PassBounds& bounds);

/// Of a mean over a square window, relative to its greatest value.
double window_bound(int filter_size);
/// Of pass 4, full scales.
double smoothing_bound(const render::SmoothingOptions& options);

/// How wrong normals and shaded colours become through the rounding of positions: a normal is as
/// wrong as the two differences of positions that it is made of, over their product.
class SurfaceBounds {
 public:
  /// `depth_m`: the z whose normals are taken; must outlive this. `position_m`: of a position.
  SurfaceBounds(const Image<double>& depth_m,
                const render::RenderOptions& options,
                double position_m);

  /// Of the unit normal; rad.
  double normal(int column, int row) const;
  /// Of Eq. (2), beside its shadow; full scales.
  double colour(int column, int row) const;

 private:
  glm::dvec3 across(int column, int row, double& lengths_m) const;

  const Image<double>& depth_m_;
  const render::RenderOptions& options_;
  render::Camera camera_;
  double position_m_;
};

/// 2^-24.
inline constexpr double kUnitRoundoff = 1.0 / (1 << 24);

}  // namespace wobblebench::bench
