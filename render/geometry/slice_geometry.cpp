#include "render/geometry/slice_geometry.h"

#include <algorithm>
#include <cmath>

namespace wobblebench::render {
namespace {

/// Depth from the centre of curvature and motor angle at (y, z); the closed form of
/// hw::ProbeGeometry without x, which the motion does not change.
struct MotionPoint {
  double depth_m, phi_rad;
};

MotionPoint unwobble(double y_m, double z_m, double axis_z_m) {
  const double along = z_m - axis_z_m;
  const double side = along < 0 ? -1 : 1;
  return {axis_z_m + side * std::hypot(y_m, along),
          std::atan2(-side * y_m, std::max(std::abs(along), 1e-300))};
}

/// Approximate distance of (y, z) from the fan's annulus, to select the entries that are needed.
double outside_m(const MotionPoint& point, const SliceGeometry& g) {
  const double beyond_rad =
      std::max({0.0, point.phi_rad - g.phi_max_rad(), g.phi_min_rad() - point.phi_rad});
  const double beyond_m =
      std::max({0.0, point.depth_m - g.depth_max_m(), g.depth_min_m() - point.depth_m});
  const double axis_distance_m = std::abs(point.depth_m - g.axis_z_m());
  return std::hypot(beyond_m, axis_distance_m * std::sin(std::min(beyond_rad, kPi / 2)));
}

/// Frames by which the motor is ahead of its frame's middle, per radian of stick angle.
double skew_per_rad(const hw::AcquisitionPlan& plan) {
  const hw::AcquisitionOptions& scan = plan.acquisition();
  const double frame_span_rad = plan.theta_step_rad() * scan.sticks_per_frame;
  const bool turns = scan.motor != hw::MotorMode::stepped;
  return turns && scan.frames_per_volume > 1 && frame_span_rad > 0 ? 1 / frame_span_rad : 0;
}

/// At least one step between `count` sticks `spacing_m` apart.
int steps_for(double spacing_m, double wanted_m, int count) {
  constexpr int kMostSteps = 8, kMostSticks = 1024;
  if (count < 2) return 1;
  const int most = std::clamp((kMostSticks - 1) / (count - 1), 1, kMostSteps);
  return std::clamp(static_cast<int>(std::ceil(spacing_m / wanted_m - 1e-9)), 1, most);
}

}  // namespace

SliceGeometry::SliceGeometry(const hw::AcquisitionPlan& plan,
                             int slice_size,
                             const DenseFactors& factors)
    : plan_(dense_plan(plan, factors)),
      slice_size_(slice_size),
      frames_(plan_.acquisition().frames_per_volume),
      frames_per_planned_frame_(factors.frames),
      frame_skew_(skew_per_rad(plan) * factors.frames),
      axis_z_m_(plan.geometry().axis_z_m()),
      r_min_m_(plan.geometry().radius_m()),
      r_max_m_(r_min_m_ + plan.acquisition().depth_m),
      half_sector_rad_(plan.acquisition().sector_rad / 2),
      x_max_m_(r_max_m_ * std::sin(half_sector_rad_)),
      depth_min_m_(r_min_m_ * std::cos(half_sector_rad_)) {
  const double half_fan_rad = plan.acquisition().fan_rad / 2;
  const double first_rad = plan_.frame_phi_rad(0), last_rad = plan_.frame_phi_rad(frames_ - 1);
  phi_min_rad_ = frames_ == 1 ? -half_fan_rad : std::min(first_rad, last_rad);
  phi_max_rad_ = frames_ == 1 ? half_fan_rad : std::max(first_rad, last_rad);
  const double skewed_rad = std::abs(frame_skew(1)) * half_sector_rad_ * plan_.phi_step_rad();
  phi_min_rad_ -= skewed_rad;
  phi_max_rad_ += skewed_rad;
}

double SliceGeometry::pixel_x_m(double column) const {
  return x_max_m_ * (2 * (column + 0.5) / slice_size_ - 1);
}

double SliceGeometry::pixel_depth_m(double row) const {
  return depth_min_m_ + (r_max_m_ - depth_min_m_) * (row + 0.5) / slice_size_;
}

double SliceGeometry::column(double x_m) const {
  return 0.5 * (x_m / x_max_m_ + 1) * slice_size_ - 0.5;
}

double SliceGeometry::row(double depth_m) const {
  return (depth_m - depth_min_m_) / (r_max_m_ - depth_min_m_) * slice_size_ - 0.5;
}

double SliceGeometry::frame_at(double phi_rad) const {
  if (frames_ == 1) return 0;
  const double first_rad = plan_.frame_phi_rad(0), last_rad = plan_.frame_phi_rad(frames_ - 1);
  return (phi_rad - first_rad) / (last_rad - first_rad) * (frames_ - 1);
}

double SliceGeometry::frame_skew(int sweep) const {
  return sweep * frame_skew_;
}

SliceGeometry::PolarIndex SliceGeometry::polar_index(double x_m, double depth_m) const {
  const double r_m = std::hypot(x_m, depth_m), theta_rad = std::atan2(x_m, depth_m);
  const hw::AcquisitionOptions& acquisition = plan_.acquisition();
  const int lines = acquisition.sticks_per_frame, samples = acquisition.samples_per_stick;
  const double line = lines == 1 ? 0 : (theta_rad - plan_.theta_rad(0)) / plan_.theta_step_rad();
  const double sample = (r_m - r_min_m_) / plan_.sample_spacing_m() - 0.5;
  return {std::clamp(line, 0.0, lines - 1.0),
          std::clamp(sample, 0.0, samples - 1.0),
          r_m >= r_min_m_ && r_m <= r_max_m_ && std::abs(theta_rad) <= half_sector_rad_};
}

SlicePoint SliceGeometry::locate(const glm::dvec3& position_m, int sweep) const {
  const hw::PolarPoint polar = plan_.geometry().to_polar(position_m);
  const double r_m = r_min_m_ + polar.range_m;
  SlicePoint point;
  point.x_m = position_m.x;
  point.depth_m = r_m * std::cos(polar.theta_rad);
  point.frame = frame_at(polar.phi_rad) - frame_skew(sweep) * polar.theta_rad;
  const bool in_fan = frames_ == 1 ? polar.phi_rad >= phi_min_rad_ && polar.phi_rad <= phi_max_rad_
                                   : point.frame >= 0 && point.frame <= frames_ - 1;
  point.inside = polar.range_m >= 0 && r_m <= r_max_m_ &&
                 std::abs(polar.theta_rad) <= half_sector_rad_ && in_fan;
  return point;
}

VolumeOfInterest field_box(const SliceGeometry& g) {
  // |x| <= R sin(s/2); y and z lie within |r cos(theta) - b| of the wobble axis, which is at most
  // R, or R - b where the axis lies behind the centre of curvature (b < 0).
  const double reach_m = g.r_max_m() + std::max(0.0, -g.axis_z_m());
  return {{0, 0, g.axis_z_m()}, {2 * g.x_max_m(), 2 * reach_m, 2 * reach_m}};
}

namespace {

/// Pixels first to last of an axis, within those that there are.
struct PixelRange {
  int first, count;
};
PixelRange pixel_range(double low, double high, int size) {
  const int first = static_cast<int>(std::clamp(std::floor(low) - 1, 0.0, size - 1.0));
  const int last = static_cast<int>(std::clamp(std::ceil(high) + 1, 0.0, size - 1.0));
  return {first, last - first + 1};
}

}  // namespace

Region pixels_within(const SliceGeometry& g, const VolumeOfInterest& box, double margin_m) {
  const auto low = [&](int i) { return box.center_m[i] - box.size_m[i] / 2 - margin_m; };
  const auto high = [&](int i) { return box.center_m[i] + box.size_m[i] / 2 + margin_m; };
  const PixelRange columns = pixel_range(g.column(low(0)), g.column(high(0)), g.slice_size());
  // Depth is axis_z_m plus the distance from the wobble axis: of the box's nearest and farthest
  // point.
  const auto nearest = [&](int i, double axis) {
    return std::max({low(i) - axis, axis - high(i), 0.0});
  };
  const auto farthest = [&](int i, double axis) {
    return std::max(std::abs(low(i) - axis), std::abs(high(i) - axis));
  };
  const double near_m = std::hypot(nearest(1, 0), nearest(2, g.axis_z_m()));
  const double far_m = std::hypot(farthest(1, 0), farthest(2, g.axis_z_m()));
  // Behind the axis the distance is subtracted.
  const bool behind = low(2) < g.axis_z_m();
  const PixelRange rows = pixel_range(g.row(g.axis_z_m() + (behind ? -far_m : near_m)),
                                      g.row(g.axis_z_m() + far_m),
                                      g.slice_size());
  return {columns.first, rows.first, columns.count, rows.count};
}

std::vector<float> make_polar_table(const SliceGeometry& geometry, const Region& pixels) {
  const int size = geometry.slice_size();
  std::vector<float> table;
  table.reserve(3 * static_cast<std::size_t>(pixels.columns) *
                static_cast<std::size_t>(pixels.rows));
  for (int row = pixels.row; row < pixels.row + pixels.rows; ++row) {
    for (int column = pixels.column; column < pixels.column + pixels.columns; ++column) {
      const auto index =
          geometry.polar_index(geometry.pixel_x_m(column), geometry.pixel_depth_m(row));
      const bool exists = row >= 0 && row < size && column >= 0 && column < size;
      const double flag = index.inside && exists ? 1 : 0;
      for (double value : {flag * index.line, flag * index.sample, flag}) {
        table.push_back(static_cast<float>(value));
      }
    }
  }
  return table;
}

MotionTable make_motion_table(const SliceGeometry& g, int size) {
  const double reach_m = std::max(g.r_max_m() - g.axis_z_m(), g.axis_z_m() - g.depth_min_m());
  const double widest_rad = std::max(-g.phi_min_rad(), g.phi_max_rad());
  const double near_arm_m = g.depth_min_m() - g.axis_z_m();
  MotionTable table;
  table.size = size;
  table.y_max_m = reach_m * std::sin(widest_rad);
  table.z_max_m = g.r_max_m();
  table.z_min_m = g.axis_z_m() + near_arm_m * (near_arm_m > 0 ? std::cos(widest_rad) : 1.0);
  // A margin of entries around the field, so that a fetch clamped to the edge of the table reads an
  // entry with flag 0.
  const double margin = 3.0 / size;
  const double y_margin_m = margin * 2 * table.y_max_m;
  const double z_margin_m = margin * (table.z_max_m - table.z_min_m);
  table.y_max_m += y_margin_m;
  table.y_min_m = -table.y_max_m;
  table.z_min_m -= z_margin_m;
  table.z_max_m += z_margin_m;

  const double dy_m = (table.y_max_m - table.y_min_m) / (size - 1);
  const double dz_m = (table.z_max_m - table.z_min_m) / (size - 1);
  const double diagonal_m = std::hypot(dy_m, dz_m);
  table.values.reserve(3 * static_cast<std::size_t>(size) * static_cast<std::size_t>(size));
  for (int row = 0; row < size; ++row) {
    for (int column = 0; column < size; ++column) {
      const MotionPoint point =
          unwobble(table.y_min_m + column * dy_m, table.z_min_m + row * dz_m, g.axis_z_m());
      const double flag = outside_m(point, g) <= diagonal_m ? 1 : 0;
      for (double value : {point.depth_m, g.frame_at(point.phi_rad), flag}) {
        table.values.push_back(static_cast<float>(value));
      }
    }
  }
  return table;
}

DenseFactors dense_factors(const hw::AcquisitionPlan& plan, const RenderOptions& options) {
  if (options.reconstruction.sticks == Sticks::plain) return {};
  const hw::ProbeGeometry geometry = plan.geometry();
  const hw::AcquisitionOptions& scan = plan.acquisition();
  const VolumeOfInterest& box = options.volume_of_interest;
  const double far_m =
      std::clamp(box.center_m.z + 0.5 * box.size_m.z, 0.0, geometry.radius_m() + scan.depth_m);
  const double wanted_m = options.reconstruction.spacing_m;
  return {
      steps_for(far_m * plan.theta_step_rad(), wanted_m, scan.sticks_per_frame),
      steps_for(
          (far_m - geometry.axis_z_m()) * plan.phi_step_rad(), wanted_m, scan.frames_per_volume)};
}

hw::AcquisitionPlan dense_plan(const hw::AcquisitionPlan& plan, const DenseFactors& factors) {
  hw::AcquisitionOptions scan = plan.acquisition();
  scan.sticks_per_frame = (scan.sticks_per_frame - 1) * factors.lines + 1;
  scan.frames_per_volume = (scan.frames_per_volume - 1) * factors.frames + 1;
  return {plan.probe(), scan};
}

}  // namespace wobblebench::render
