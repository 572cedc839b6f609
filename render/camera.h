// Rays of a picture: shared by the GL passes, the reference and the truth.
#pragma once

#include <glm/vec3.hpp>

#include "hw/probe/probe.h"
#include "render/options.h"

namespace wobblebench::render {

/// A place in the picture: column and row of pixels' middles (0: the first pixel's), and depth.
struct PicturePoint {
  double column = 0;
  double row = 0;
  double depth_m = 0;
};

/// The picture's place in the probe frame. The view plane is a square as wide as the longer side of
/// the volume of interest's x and y at rest, at a distance that keeps the whole box behind it for
/// every turn; it turns about the box's centre.
///
/// Turns: yaw first, about the picture's vertical; then pitch, about its turned horizontal; then
/// roll, which turns the camera clockwise as the viewer sees it.
struct Camera {
  Projection projection = Projection::parallel;
  glm::dvec3 center{0};  ///< of the volume of interest
  glm::dvec3 right{1, 0, 0};
  glm::dvec3 down{0, 1, 0};
  glm::dvec3 forward{0, 0, 1};
  double width_m = 0;           ///< of the view plane's square
  double plane_distance_m = 0;  ///< parallel: view plane to centre
  double eye_distance_m = 0;    ///< perspective: eye to centre; the square then passes the centre
  int image_size = 0;

  double pixel_m() const { return width_m / image_size; }
  /// The ray of a pixel's middle: origin on the view plane (parallel) or at the eye (perspective);
  /// distances along it are the picture's depth.
  hw::Ray ray(double column, double row) const;
  /// The inverse: where a place in front of the eye appears.
  PicturePoint project(const glm::dvec3& position_m) const;
};

Camera make_camera(const RenderOptions& options);

/// Where a ray, from its origin on, is inside the volume of interest; empty when `to_m` < `from_m`.
struct Span {
  double from_m = 0;
  double to_m = -1;
};
Span clip_to_box(const hw::Ray& ray, const VolumeOfInterest& box);

/// Length of a step: the depth of the volume of interest over the number of steps.
double step_m(const RenderOptions& options);

}  // namespace wobblebench::render
