// The single passes of the double-precision reference (render/reference/reference.h).
#pragma once

#include <glm/vec3.hpp>
#include <vector>

#include "hw/probe/polar_volume.h"
#include "render/camera.h"
#include "render/geometry/slice_geometry.h"
#include "render/options.h"
#include "render/picture.h"

namespace wobblebench::render::reference {

/// Result of pass 1: scan-converted, filtered slices.
class SliceStack {
 public:
  SliceStack(const hw::PolarVolume& volume, const RenderOptions& options);

  struct Sample {
    double value = 0;
    bool inside = false;  ///< in the cone of valid data
  };
  /// Trilinear interpolation at a position of the probe frame, by the closed-form geometry.
  Sample at(const glm::dvec3& position_m) const;

  const SliceGeometry& geometry() const { return geometry_; }
  /// detection_level() of the volume.
  double level() const { return level_; }
  void set_level(double level) { level_ = level; }
  /// Value of a slice's pixel.
  double pixel(int frame, int column, int row) const {
    return slices_[static_cast<std::size_t>(frame)].at(column, row);
  }

 private:
  SliceGeometry geometry_;
  int sweep_;
  FrameSpan covered_;
  double level_ = 0;
  std::vector<Image<double>> slices_;
};

/// Result of pass 2.
struct Cast {
  Image<double> depth_m;  ///< NaN where there is no surface
  Image<glm::dvec3> volume;
};
Cast cast_rays(const SliceStack& slices, const RenderOptions& options);

/// Between passes 2 and 3: RayCastingOptions::incidence_correction_m.
Image<double> correct_incidence(const Image<double>& depth_m,
                                const hw::AcquisitionPlan& plan,
                                const RenderOptions& options);

/// Pass 3, first half: box filter over neighbours with a surface.
Image<double> filter_depth(const Image<double>& depth_m, int filter_size);

/// Pass 3, second half. `rendered`: pass 2's volume picture, read with ShadingBase::rendered only.
Image<glm::dvec3> shade(const Image<double>& depth_m,
                        const Image<glm::dvec3>& rendered,
                        const RenderOptions& options);

/// Pass 4.
Image<glm::dvec3> smooth(const Image<glm::dvec3>& picture, const SmoothingOptions& options);

}  // namespace wobblebench::render::reference
