// B-mode pictures of planes through a scan, and where a surface of the picture cuts them.
#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <vector>

#include "base/image.h"
#include "bench/output/picture/panels.h"
#include "hw/probe/polar_volume.h"
#include "render/camera.h"

namespace wobblebench::bench {

/// A square picture of a plane of the probe frame.
struct ScanPlane {
  glm::dvec3 corner_m{0};  ///< centre of the upper left pixel
  glm::dvec3 right{1, 0, 0};
  glm::dvec3 down{0, 0, 1};
  double pixel_m = 1e-3;
  int side = 0;

  glm::dvec3 position_m(double column, double row) const {
    return corner_m + pixel_m * (column * right + row * down);
  }
  /// Column and row of a position's foot point.
  glm::dvec2 pixel(const glm::dvec3& position_m) const;
  /// Signed distance of a position.
  double height_m(const glm::dvec3& position_m) const;
};

/// The plane of a frame of the fan, and the whole sector in it.
ScanPlane frame_plane(const hw::AcquisitionPlan& plan, int frame, int side);
/// The plane x = 0, across all frames, and the whole fan in it.
ScanPlane plane_across_frames(const hw::AcquisitionPlan& plan, int side);

/// Samples of the sticks at the plane's pixels, trilinear between neighbours in range, stick angle
/// and planned motor angle; NaN outside sector, fan and depth.
Image<float> scan_converted(const hw::PolarVolume& volume, const ScanPlane& plane);

/// Where the surface of a depth image, as the camera's rays meet it, cuts the plane. It ends where
/// depths of neighbouring pixels differ by more than 3 mm, or three pixels where that is more.
std::vector<Segment> surface_in_plane(const Image<float>& depth_m,
                                      const render::Camera& camera,
                                      const ScanPlane& plane);

}  // namespace wobblebench::bench
