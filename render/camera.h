// Rays of a picture, for the GL passes, the double-precision reference and the ground truth.
#pragma once

#include <glm/vec3.hpp>

#include "hw/probe/probe.h"
#include "render/options.h"

namespace wobblebench::render {

/// A point of the picture: fractional column and row, 0 at the first pixel's centre, and depth.
struct PicturePoint {
  double column = 0;
  double row = 0;
  double depth_m = 0;
};

/// Position and orientation of the picture in the probe frame. The view plane is a square, as wide
/// as the longer of the volume of interest's x and y sides, that turns about the box's centre at a
/// distance that keeps the whole box behind it.
///
/// Rotations: first yaw, about the picture's vertical axis; then pitch, about the horizontal axis
/// so turned; then roll, clockwise for the viewer. A flip then mirrors the picture: `right` points
/// the other way, and the axes are left-handed.
///
/// @code
/// render::RenderOptions options;
/// options.view.yaw_rad = 30 * kDegree;
/// const render::Camera camera = render::make_camera(options);
/// const hw::Ray ray = camera.ray(0, 0);
/// const render::PicturePoint point = camera.project(ray.at(0.1));
/// static_cast<void>(point.depth_m);  // 0.1
/// @endcode
struct Camera {
  Projection projection = Projection::parallel;
  glm::dvec3 center{0};  ///< of the volume of interest
  glm::dvec3 right{1, 0, 0};
  glm::dvec3 down{0, 1, 0};
  glm::dvec3 forward{0, 0, 1};
  double width_m = 0;           ///< of the view plane
  double plane_distance_m = 0;  ///< parallel: view plane to centre
  double eye_distance_m = 0;    ///< perspective: eye to centre, through which the view plane goes
  int image_size = 0;
  bool flipped = false;

  double pixel_m() const { return width_m / image_size; }
  /// The ray through a point of the picture: origin on the view plane (parallel) or at the eye
  /// (perspective). Depth is the distance along it.
  hw::Ray ray(double column, double row) const;
  /// The inverse, for a position in front of the eye.
  PicturePoint project(const glm::dvec3& position_m) const;
};

Camera make_camera(const RenderOptions& options);

/// Part of a ray, from its origin on, as distances along it; empty when `to_m` < `from_m`.
struct Span {
  double from_m = 0;
  double to_m = -1;
};
/// The part inside the box.
Span clip_to_box(const hw::Ray& ray, const VolumeOfInterest& box);

/// Length of a step along a ray: depth of the volume of interest over the number of steps.
double step_m(const RenderOptions& options);

}  // namespace wobblebench::render
