// Errors of one pixel of pass 3: of its normal, and of its colour.
#pragma once

#include <glm/vec3.hpp>

#include "base/image.h"
#include "render/camera.h"
#include "render/options.h"

namespace wobblebench::bench {

/// Of a surface with positions rounded by `position_m`. A normal is the product of two differences
/// of positions: it is as wrong as they are, over their product. At most 2, its greatest change.
class SurfaceBounds {
 public:
  /// `depth_m`: the surface whose normals are taken; must outlive this.
  SurfaceBounds(const Image<double>& depth_m,
                const render::RenderOptions& options,
                double position_m);

  /// Of the unit normal; rad.
  double normal(int column, int row) const;
  /// Of Eq. (2), beside its shadow.
  double colour(int column, int row) const;

 private:
  glm::dvec3 across(int column, int row, double& lengths_m) const;

  const Image<double>& depth_m_;
  const render::RenderOptions& options_;
  render::Camera camera_;
  double position_m_;
};

}  // namespace wobblebench::bench
