#include "render/leaping/skippable_cells.h"

#include <algorithm>
#include <cmath>

#include "render/camera.h"
#include "render/passes/ray_sampling.h"

namespace wobblebench::render {
namespace {

/// Rounding of a slice's values, and of a driver's filter beyond its 8-bit fractions.
double value_rounding(TextureFormat format) {
  switch (format) {
    case TextureFormat::r8:
      return 2.0 / 255;
    case TextureFormat::r16:
      return 2.0 / 65535;
    case TextureFormat::r32f:
      return 1e-6;
  }
  return 1;
}

/// 8-bit fractions of a driver's filter make slopes steeper by less than this.
constexpr double kSlopeMargin = 1.02;

/// For each entry of the transfer table, the first from there on that is not transparent.
std::vector<int> next_visible(const RenderOptions& options) {
  const TransferFunction transfer(options.ray_casting, step_m(options));
  const int none = kTransferTableSize + 2;  // beyond what a range of values is widened to
  std::vector<int> next(kTransferTableSize + 1, none);
  if (options.ray_casting.mode == RenderMode::surface) return next;
  for (int entry = kTransferTableSize - 1; entry >= 0; --entry) {
    const bool visible = transfer.step_opacity(entry / (kTransferTableSize - 1.0)) > 0;
    next[static_cast<std::size_t>(entry)] =
        visible ? entry : next[static_cast<std::size_t>(entry) + 1];
  }
  return next;
}

double steepest_quiet_per_m(const RenderOptions& options) {
  const RayCastingOptions& o = options.ray_casting;
  const double half = 0.5 * o.buffer_length;
  const double rounding = o.buffer_length * value_rounding(options.scan_conversion.format);
  return (o.threshold - rounding) / (half * half * step_m(options) * kSlopeMargin);
}

/// A rectangle of the image plane.
struct Rectangle {
  double x_low, x_high, depth_low, depth_high;

  double nearest_r() const {
    return std::hypot(std::max({x_low, -x_high, 0.0}), std::max({depth_low, -depth_high, 0.0}));
  }
  double farthest_r() const {
    return std::hypot(std::max(-x_low, x_high), std::max(-depth_low, depth_high));
  }
  /// Angles from straight ahead; all of them where the rectangle reaches behind the centre.
  double theta_low() const {
    return depth_low <= 0 ? -kPi : std::atan2(x_low, x_low < 0 ? depth_low : depth_high);
  }
  double theta_high() const {
    return depth_low <= 0 ? kPi : std::atan2(x_high, x_high < 0 ? depth_high : depth_low);
  }
};

/// Angle by which a path of this length can turn about a centre that it keeps this far from.
double turn_rad(double length_m, double distance_m) {
  return length_m < distance_m ? std::asin(length_m / distance_m) : kPi;
}

int clamped_entry(double value) {
  const double last = kTransferTableSize - 1;
  return static_cast<int>(std::clamp(value * last, 0.0, last));
}

/// The greatest product of a number between low and high and a slope between -fall and rise.
double greatest_product(double low, double high, double fall, double rise) {
  return std::max({low * rise, high * rise, -low * fall, -high * fall});
}

int whole_cells(double cells) {
  const double rounding = 1e-9;
  return static_cast<int>(std::ceil(std::max(cells - rounding, 0.0)));
}

}  // namespace

SkippableCells::SkippableCells(const hw::AcquisitionPlan& plan,
                               const SliceGeometry& geometry,
                               const RenderOptions& options,
                               const Region& pixels)
    : geometry_(geometry),
      lattice_(make_macrocell_grid(geometry, pixels)),
      pixel_x_m_(geometry.pixel_x_m(1) - geometry.pixel_x_m(0)),
      pixel_depth_m_(geometry.pixel_depth_m(1) - geometry.pixel_depth_m(0)),
      phi_step_rad_(plan.phi_step_rad()),
      can_leap_(geometry.frames() > 1 && geometry.depth_min_m() > geometry.axis_z_m()),
      detects_(options.ray_casting.mode != RenderMode::volume),
      rising_(options.ray_casting.edge == EdgeSign::rising),
      steepest_quiet_per_m_(steepest_quiet_per_m(options)),
      next_visible_(next_visible(options)),
      buffer_{options.ray_casting.buffer_length * step_m(options), kernel_reach_m(options)},
      kernel_{0, kernel_reach_m(options)} {
  const auto cells =
      static_cast<std::size_t>(lattice_.columns) * static_cast<std::size_t>(lattice_.rows);
  bounds_.assign(static_cast<std::size_t>(lattice_.intervals), std::vector<MacrocellBounds>(cells));
  for (int row = 0; row < lattice_.rows; ++row) {
    for (int column = 0; column < lattice_.columns; ++column) {
      places_.push_back(place_of(column, row));
    }
  }
  look(options);
}

/// Distance from the wobble axis to the row's near side.
double SkippableCells::arm_m(int row) const {
  const double first_pixel = lattice_.pixels.row + row * lattice_.cell_pixels - 0.5;
  return geometry_.pixel_depth_m(first_pixel) - geometry_.axis_z_m();
}

SkippableCells::Place SkippableCells::place_of(int column, int row) const {
  const double rounding = 1e-3;  // of a pixel
  const double left = lattice_.pixels.column + column * lattice_.cell_pixels - 0.5 - rounding;
  const double top = lattice_.pixels.row + row * lattice_.cell_pixels - 0.5 - rounding;
  const double side = lattice_.cell_pixels + 2 * rounding;
  const SliceGeometry& g = geometry_;
  const Rectangle cell = {g.pixel_x_m(left),
                          g.pixel_x_m(left + side),
                          g.pixel_depth_m(top),
                          g.pixel_depth_m(top + side)};
  const double half_rad = g.half_sector_rad();
  if (cell.nearest_r() > g.r_max_m() || cell.farthest_r() < g.r_min_m() ||
      cell.theta_low() > half_rad || cell.theta_high() < -half_rad) {
    return Place::outside;
  }
  const bool inside = cell.nearest_r() >= g.r_min_m() && cell.farthest_r() <= g.r_max_m() &&
                      cell.theta_low() >= -half_rad && cell.theta_high() <= half_rad;
  return inside ? Place::inside : Place::border;
}

void SkippableCells::set_bounds(int interval, std::vector<MacrocellBounds> bounds) {
  bounds_.at(static_cast<std::size_t>(interval)) = std::move(bounds);
}

void SkippableCells::look(const RenderOptions& options) {
  const Camera camera = make_camera(options);
  forward_ = camera.forward;
  const bool perspective = camera.projection == Projection::perspective;
  const double half_diagonal_m = camera.width_m / std::sqrt(2.0);
  spread_ = perspective ? half_diagonal_m / camera.eye_distance_m : 0;
}

/// Within an interval, and this angle beyond it.
SkippableCells::Directions SkippableCells::directions(int interval, double margin_rad) const {
  const double phi_rad = (interval + 0.5 - geometry_.frame_at(0)) * phi_step_rad_;
  const double half_rad = (geometry_.is_skewed() ? 1.0 : 0.5) * phi_step_rad_;
  const double spread = spread_ + half_rad + margin_rad;
  const auto around = [](double middle, double margin) {
    return Range{std::max(middle - margin, -1.0), std::min(middle + margin, 1.0)};
  };
  const double away = forward_.z * std::cos(phi_rad) - forward_.y * std::sin(phi_rad);
  const double about = -forward_.y * std::cos(phi_rad) - forward_.z * std::sin(phi_rad);
  return {around(forward_.x, spread_), around(away, spread), around(about, spread)};
}

/// How steeply an edge of the wanted sign can rise along a ray in a cell.
double SkippableCells::steepest_per_m(const MacrocellBounds& bounds,
                                      const Directions& along,
                                      double arm_m) const {
  const auto steepest = [&](const Range& part, const Steps& steps) {
    return rising_ ? greatest_product(part.low, part.high, steps.fall, steps.rise)
                   : greatest_product(part.low, part.high, steps.rise, steps.fall);
  };
  const double frame_m = arm_m * phi_step_rad_;
  const double skew = std::abs(geometry_.frame_skew(1)) * frame_m / (arm_m + geometry_.axis_z_m());
  const Range about = {along.about.low - skew, along.about.high + skew};
  return steepest(along.x, bounds.x) / pixel_x_m_ +
         steepest(along.away, bounds.depth) / pixel_depth_m_ +
         steepest(about, bounds.frame) / frame_m;
}

bool SkippableCells::is_visible(float low, float high) const {
  const float rounding = 1.0f / kTransferTableSize;
  return next_visible_[static_cast<std::size_t>(clamped_entry(low - rounding))] <=
         clamped_entry(high + rounding) + 1;
}

/// Cells whose samples depend on one of `bits`: those downstream of it by what counts behind a
/// sample, and around it.
CellBits SkippableCells::dilated(const CellBits& bits, const Reach& reach) const {
  const int rows = lattice_.rows, intervals = lattice_.intervals;
  const double cell_x_m = pixel_x_m_ * lattice_.cell_pixels;
  const double cell_depth_m = pixel_depth_m_ * lattice_.cell_pixels;
  const auto upstream = [&](const Range& part) {  // as lengths, against the axis and along it
    return std::pair(std::max(-part.low, 0.0) * reach.behind_m + reach.around_m,
                     std::max(part.high, 0.0) * reach.behind_m + reach.around_m);
  };
  CellBits carried_on(bits.size(), 0);
  for (int interval = 0; interval < intervals; ++interval) {
    for (int row = 0; row < rows; ++row) {
      const double arm = arm_m(row), length_m = reach.behind_m + reach.around_m;
      const double nearest_m = std::max(arm - length_m, 1e-3 * arm);
      const Directions along = directions(interval, turn_rad(length_m, arm));
      const auto [right_m, left_m] = upstream(along.x);
      const auto [farther_m, nearer_m] = upstream(along.away);
      const auto [after_m, before_m] = upstream(along.about);
      const double frame_m = nearest_m * phi_step_rad_;
      const double skewed =
          std::abs(geometry_.frame_skew(1)) * turn_rad(length_m, geometry_.r_min_m());
      const int first_row = std::max(row - whole_cells(nearer_m / cell_depth_m), 0);
      const int last_row = std::min(row + whole_cells(farther_m / cell_depth_m), rows - 1);
      const int first = std::max(interval - whole_cells(before_m / frame_m + skewed), 0);
      const int last = std::min(interval + whole_cells(after_m / frame_m + skewed), intervals - 1);
      std::uint64_t found = 0;
      for (int k = first; k <= last; ++k) {
        for (int j = first_row; j <= last_row; ++j) {
          found |= bits[static_cast<std::size_t>(k * rows + j)];
        }
      }
      carried_on[static_cast<std::size_t>(interval * rows + row)] =
          carried(found, whole_cells(right_m / cell_x_m), whole_cells(left_m / cell_x_m)) &
          all_columns(lattice_);
    }
  }
  return carried_on;
}

CellBits SkippableCells::to_sample() const {
  const std::size_t words =
      static_cast<std::size_t>(lattice_.rows) * static_cast<std::size_t>(lattice_.intervals);
  CellBits steep(words, 0), visible(words, 0), border(words, 0);
  for (std::size_t word = 0; word < words; ++word) {
    const int interval = static_cast<int>(word) / lattice_.rows;
    const int row = static_cast<int>(word) % lattice_.rows;
    const Directions along = directions(interval, 0);
    const bool outermost = interval == 0 || interval == lattice_.intervals - 1;
    const auto row_begin =
        static_cast<std::size_t>(row) * static_cast<std::size_t>(lattice_.columns);
    const MacrocellBounds* row_bounds =
        bounds_[static_cast<std::size_t>(interval)].data() + row_begin;
    for (int column = 0; column < lattice_.columns; ++column) {
      const std::uint64_t bit = std::uint64_t{1} << column;
      const Place place = places_[row_begin + static_cast<std::size_t>(column)];
      if (place == Place::outside) continue;
      const MacrocellBounds& cell = row_bounds[column];
      if (place == Place::border) border[word] |= bit;
      // Where some of a kernel's taps lie outside the cone, its mean may change faster than they
      // do.
      const bool cut_kernel = kernel_.around_m > 0 && (outermost || place == Place::border);
      if (detects_ &&
          (cut_kernel || steepest_per_m(cell, along, arm_m(row)) >= steepest_quiet_per_m_)) {
        steep[word] |= bit;
      }
      if (is_visible(cell.low, cell.high)) visible[word] |= bit;
    }
  }
  steep = dilated(steep, buffer_);
  visible = dilated(visible, kernel_);
  for (std::size_t word = 0; word < words; ++word) border[word] |= steep[word] | visible[word];
  return border;
}

std::vector<std::uint8_t> SkippableCells::distances() const {
  const auto cells = static_cast<std::size_t>(lattice_.columns) *
                     static_cast<std::size_t>(lattice_.rows) *
                     static_cast<std::size_t>(lattice_.intervals);
  if (!can_leap_) return std::vector<std::uint8_t>(cells, 0);
  return cell_distances(to_sample(), lattice_);
}

}  // namespace wobblebench::render
