#include "bench/output/picture/scan_plane.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <optional>

#include "base/parallel.h"
#include "render/geometry/slice_geometry.h"

namespace wobblebench::bench {

namespace {

constexpr int kEdgeSteps = 32;       // of the field's outline
constexpr double kTolerance = 1e-6;  // frames and radians that rounding may cost
constexpr double kJump_m = 3e-3;

/// A picture of the plane through `origin` that holds the points.
ScanPlane plane_around(ScanPlane plane, const std::vector<glm::dvec3>& points_m) {
  glm::dvec2 low(INFINITY), high(-INFINITY);
  for (const glm::dvec3& point_m : points_m) {
    const glm::dvec2 at(glm::dot(point_m, plane.right), glm::dot(point_m, plane.down));
    low = glm::dvec2(std::min(low.x, at.x), std::min(low.y, at.y));
    high = glm::dvec2(std::max(high.x, at.x), std::max(high.y, at.y));
  }
  const double extent_m = std::max(high.x - low.x, high.y - low.y);
  plane.pixel_m = extent_m / plane.side;
  const glm::dvec2 corner = 0.5 * (low + high) - glm::dvec2(0.5 * (extent_m - plane.pixel_m));
  // The plane's distance from the origin stays.
  const glm::dvec3 normal = glm::cross(plane.right, plane.down);
  plane.corner_m =
      corner.x * plane.right + corner.y * plane.down + glm::dot(points_m.front(), normal) * normal;
  return plane;
}

/// Samples of a volume at positions between its sticks.
class Samples {
 public:
  explicit Samples(const hw::PolarVolume& volume)
      : volume_(volume),
        geometry_(volume.plan(), 1),
        sweep_(volume.plan().sweep_direction(volume.volume_index())) {}

  float at(const glm::dvec3& position_m) const {
    const render::SlicePoint point = geometry_.locate(position_m, sweep_);
    const auto polar = geometry_.polar_index(point.x_m, point.depth_m);
    if (!polar.inside || !in_fan(position_m, point.frame)) return kNoSurface;
    const int last = geometry_.frames() - 1;
    const double frame = std::clamp(point.frame, 0.0, static_cast<double>(last));
    const int low = std::min(static_cast<int>(frame), std::max(0, last - 1));
    const double part = frame - low;
    const double near = in_frame(low, polar);
    if (part == 0) return static_cast<float>(near);
    return static_cast<float>((1 - part) * near + part * in_frame(low + 1, polar));
  }

 private:
  bool in_fan(const glm::dvec3& position_m, double frame) const {
    if (geometry_.frames() > 1) {
      return frame >= -kTolerance && frame <= geometry_.frames() - 1 + kTolerance;
    }
    const double phi_rad = volume_.plan().geometry().to_polar(position_m).phi_rad;
    return phi_rad >= geometry_.phi_min_rad() && phi_rad <= geometry_.phi_max_rad();
  }

  /// Bilinear between lines and samples.
  double in_frame(int frame, const render::SliceGeometry::PolarIndex& at) const {
    const hw::AcquisitionOptions& acquisition = volume_.plan().acquisition();
    const int line = static_cast<int>(at.line);
    const int next = std::min(line + 1, acquisition.sticks_per_frame - 1);
    const double part = at.line - line;
    return (1 - part) * on_line(frame, line, at.sample) + part * on_line(frame, next, at.sample);
  }

  double on_line(int frame, int line, double sample) const {
    const int count = volume_.plan().acquisition().samples_per_stick;
    const int low = static_cast<int>(sample);
    const double part = sample - low;
    const auto first = static_cast<std::size_t>(line) * static_cast<std::size_t>(count);
    const std::vector<float>& samples = volume_.frame(frame).samples;
    const auto value = [&](int k) {
      return static_cast<double>(samples[first + static_cast<std::size_t>(std::min(k, count - 1))]);
    };
    return (1 - part) * value(low) + part * value(low + 1);
  }

  const hw::PolarVolume& volume_;
  render::SliceGeometry geometry_;
  int sweep_;
};

/// A pixel's surface: where, and how far off the plane.
struct SurfacePoint {
  glm::dvec3 position_m{0};
  double height_m = 0;
  double depth_m = 0;  ///< NaN: none
};

/// Where the line between two neighbours meets the plane.
std::optional<glm::dvec3> crossing(const SurfacePoint& a, const SurfacePoint& b, double jump_m) {
  if (!(std::abs(a.depth_m - b.depth_m) <= jump_m)) return {};
  if ((a.height_m < 0) == (b.height_m < 0)) return {};
  const double part = a.height_m / (a.height_m - b.height_m);
  return a.position_m + part * (b.position_m - a.position_m);
}

std::vector<SurfacePoint> surface_points(const Image<float>& depth_m,
                                         const render::Camera& camera,
                                         const ScanPlane& plane,
                                         int row) {
  std::vector<SurfacePoint> points(static_cast<std::size_t>(depth_m.width));
  for (int column = 0; column < depth_m.width; ++column) {
    SurfacePoint& point = points[static_cast<std::size_t>(column)];
    point.depth_m = static_cast<double>(depth_m.at(column, row));
    if (std::isnan(point.depth_m)) continue;
    point.position_m = camera.ray(column, row).at(point.depth_m);
    point.height_m = plane.height_m(point.position_m);
  }
  return points;
}

}  // namespace

glm::dvec2 ScanPlane::pixel(const glm::dvec3& position_m) const {
  const glm::dvec3 from = (position_m - corner_m) / pixel_m;
  return {glm::dot(from, right), glm::dot(from, down)};
}

double ScanPlane::height_m(const glm::dvec3& position_m) const {
  return glm::dot(position_m - corner_m, glm::cross(right, down));
}

ScanPlane frame_plane(const hw::AcquisitionPlan& plan, int frame, int side) {
  const double phi_rad = plan.frame_phi_rad(frame);
  const double half_rad = 0.5 * plan.acquisition().sector_rad;
  std::vector<glm::dvec3> outline;
  for (int i = 0; i <= kEdgeSteps; ++i) {
    const double theta_rad = half_rad * (2.0 * i / kEdgeSteps - 1);
    for (const double range_m : {0.0, plan.acquisition().depth_m}) {
      outline.push_back(plan.geometry().to_cartesian({range_m, theta_rad, phi_rad}));
    }
  }
  return plane_around(
      {.right = {1, 0, 0}, .down = {0, -std::sin(phi_rad), std::cos(phi_rad)}, .side = side},
      outline);
}

ScanPlane plane_across_frames(const hw::AcquisitionPlan& plan, int side) {
  const double half_rad = 0.5 * plan.acquisition().fan_rad;
  std::vector<glm::dvec3> outline;
  for (int i = 0; i <= kEdgeSteps; ++i) {
    const double phi_rad = half_rad * (2.0 * i / kEdgeSteps - 1);
    for (const double range_m : {0.0, plan.acquisition().depth_m}) {
      outline.push_back(plan.geometry().to_cartesian({range_m, 0, phi_rad}));
    }
  }
  return plane_around({.right = {0, 1, 0}, .down = {0, 0, 1}, .side = side}, outline);
}

Image<float> scan_converted(const hw::PolarVolume& volume, const ScanPlane& plane) {
  const Samples samples(volume);
  Image<float> picture(plane.side, plane.side);
  parallel_rows(plane.side, [&](int row) {
    for (int column = 0; column < plane.side; ++column) {
      picture.at(column, row) = samples.at(plane.position_m(column, row));
    }
  });
  return picture;
}

std::vector<Segment> surface_in_plane(const Image<float>& depth_m,
                                      const render::Camera& camera,
                                      const ScanPlane& plane) {
  const double jump_m = std::max(kJump_m, 3 * camera.pixel_m());
  std::vector<Segment> segments;
  std::vector<SurfacePoint> above;
  for (int row = 0; row < depth_m.height; ++row) {
    std::vector<SurfacePoint> here = surface_points(depth_m, camera, plane, row);
    for (std::size_t i = 1; row > 0 && i < here.size(); ++i) {
      std::vector<glm::dvec2> ends;
      const auto add = [&](const SurfacePoint& a, const SurfacePoint& b) {
        if (const auto at = crossing(a, b, jump_m)) ends.push_back(plane.pixel(*at));
      };
      add(above[i - 1], above[i]);
      add(above[i], here[i]);
      add(here[i], here[i - 1]);
      add(here[i - 1], above[i - 1]);
      for (std::size_t k = 1; k < ends.size(); k += 2) segments.push_back({ends[k - 1], ends[k]});
    }
    above = std::move(here);
  }
  return segments;
}

}  // namespace wobblebench::bench
