#include "render/leaping/skippable_cells.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "base/parallel.h"
#include "render/camera.h"
#include "render/geometry/ray_sampling.h"

namespace wobblebench::render {
namespace {

/// Rounding error of a slice's values and of a driver's filter, apart from its 8-bit fractions.
double value_rounding(TextureFormat format) {
  switch (format) {
    case TextureFormat::r8:
      return 2.0 / 255;
    case TextureFormat::r16:
      return 2.0 / 65535;
    case TextureFormat::r32f:
      return 3e-6;  // edge_detector.glsl sums multiples of 2^-18
  }
  return 1;
}

/// Factor by which the 8-bit fractions of a driver's filter can increase slopes.
constexpr double kSlopeMargin = 1.02;

/// For each entry of the transfer table, the first one from there on that is not transparent.
std::vector<int> next_visible(const RenderOptions& options) {
  const TransferFunction transfer(options.ray_casting, step_m(options));
  const int none = kTransferTableSize + 2;  // beyond any entry that is_visible() compares it with
  std::vector<int> next(kTransferTableSize + 1, none);
  if (options.ray_casting.mode == RenderMode::surface) return next;
  for (int entry = kTransferTableSize - 1; entry >= 0; --entry) {
    const bool visible = transfer.step_opacity(entry / (kTransferTableSize - 1.0)) > 0;
    next[static_cast<std::size_t>(entry)] =
        visible ? entry : next[static_cast<std::size_t>(entry) + 1];
  }
  return next;
}

/// Slope along a ray below which Difference, Eq. (1), stays below the threshold.
double max_slope_without_edge_per_m(const RenderOptions& options) {
  const int n = buffer_samples(options);
  const double half = 0.5 * n;
  const double rounding = n * value_rounding(options.scan_conversion.format);
  return (difference_threshold(options) - rounding) /
         (half * half * step_m(options) * kSlopeMargin);
}

/// Value that a sample of the buffer must reach for Difference, Eq. (1), to reach the threshold:
/// samples are not negative, so it is at most n / 2 times the largest of them.
double least_bright_value(const RenderOptions& options) {
  return 2 * difference_threshold(options) / buffer_samples(options) -
         value_rounding(options.scan_conversion.format);
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
  /// Range of theta; all angles if the rectangle reaches behind the centre of curvature.
  double theta_low() const {
    return depth_low <= 0 ? -kPi : std::atan2(x_low, x_low < 0 ? depth_low : depth_high);
  }
  double theta_high() const {
    return depth_low <= 0 ? kPi : std::atan2(x_high, x_high < 0 ? depth_high : depth_low);
  }
};

/// Largest angle about a centre that a path of this length covers from a point at this distance.
double turn_rad(double length_m, double distance_m) {
  return length_m < distance_m ? std::asin(length_m / distance_m) : kPi;
}

int clamped_entry(double value) {
  const double last = kTransferTableSize - 1;
  return static_cast<int>(std::clamp(value * last, 0.0, last));
}

/// Largest product of a number in [low, high] and a slope in [-fall, rise].
double max_product(double low, double high, double fall, double rise) {
  return std::max({low * rise, high * rise, -low * fall, -high * fall});
}

int whole_cells(double cells) {
  const double rounding = 1e-9;
  return static_cast<int>(std::ceil(std::max(cells - rounding, 0.0)));
}

constexpr int kMaxColumns = 64;  ///< a row of cells is one word of bits
constexpr int kMinCellPixels = 4;

/// Dilates by one cell along an axis of `count` words that are `stride` apart.
void dilate_along(CellBits& words, std::size_t count, std::size_t stride) {
  const CellBits before = words;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const std::size_t index = i / stride % count;
    if (index > 0) words[i] |= before[i - stride];
    if (index + 1 < count) words[i] |= before[i + stride];
  }
}

/// The set and all cells adjacent to it.
CellBits dilated_by_one(CellBits set, const MacrocellGrid& grid) {
  for (std::uint64_t& word : set) word = dilated_columns(word, 1, 1) & column_mask(grid);
  const auto rows = static_cast<std::size_t>(grid.rows);
  dilate_along(set, rows, 1);
  dilate_along(set, static_cast<std::size_t>(grid.intervals), rows);
  return set;
}

}  // namespace

SkippableCells::SkippableCells(const hw::AcquisitionPlan& plan,
                               const SliceGeometry& geometry,
                               const RenderOptions& options,
                               const Region& pixels)
    : geometry_(geometry),
      grid_(make_macrocell_grid(geometry, pixels)),
      pixel_x_m_(geometry.pixel_x_m(1) - geometry.pixel_x_m(0)),
      pixel_depth_m_(geometry.pixel_depth_m(1) - geometry.pixel_depth_m(0)),
      phi_step_rad_(plan.phi_step_rad()),
      can_leap_(geometry.frames() > 1 && geometry.depth_min_m() > geometry.axis_z_m()),
      detects_(options.ray_casting.mode != RenderMode::volume),
      rising_(options.ray_casting.edge == EdgeSign::rising),
      detector_(options.ray_casting.detector),
      covered_{0, geometry.frames() - 1.0},
      value_rounding_(value_rounding(options.scan_conversion.format)),
      max_slope_without_edge_per_m_(max_slope_without_edge_per_m(options)),
      least_bright_value_(least_bright_value(options)),
      next_visible_(next_visible(options)),
      buffer_{detector_samples(options) * step_m(options), kernel_radius_m(options)},
      kernel_{0, kernel_radius_m(options)} {
  const auto cells = static_cast<std::size_t>(grid_.columns) * static_cast<std::size_t>(grid_.rows);
  bounds_.assign(static_cast<std::size_t>(grid_.intervals), std::vector<MacrocellBounds>(cells));
  for (int row = 0; row < grid_.rows; ++row) {
    for (int column = 0; column < grid_.columns; ++column) {
      overlaps_.push_back(cone_overlap(column, row));
    }
  }
  set_view(options);
}

/// Distance of the row's near side from the wobble axis.
double SkippableCells::axis_distance_m(int row) const {
  const double first_pixel = grid_.pixels.row + row * grid_.cell_pixels - 0.5;
  return geometry_.pixel_depth_m(first_pixel) - geometry_.axis_z_m();
}

SkippableCells::ConeOverlap SkippableCells::cone_overlap(int column, int row) const {
  const double rounding = 1e-3;  // of a pixel
  const double left = grid_.pixels.column + column * grid_.cell_pixels - 0.5 - rounding;
  const double top = grid_.pixels.row + row * grid_.cell_pixels - 0.5 - rounding;
  const double side = grid_.cell_pixels + 2 * rounding;
  const SliceGeometry& g = geometry_;
  const Rectangle cell = {g.pixel_x_m(left),
                          g.pixel_x_m(left + side),
                          g.pixel_depth_m(top),
                          g.pixel_depth_m(top + side)};
  const double half_rad = g.half_sector_rad();
  if (cell.nearest_r() > g.r_max_m() || cell.farthest_r() < g.r_min_m() ||
      cell.theta_low() > half_rad || cell.theta_high() < -half_rad) {
    return ConeOverlap::outside;
  }
  const bool inside = cell.nearest_r() >= g.r_min_m() && cell.farthest_r() <= g.r_max_m() &&
                      cell.theta_low() >= -half_rad && cell.theta_high() <= half_rad;
  return inside ? ConeOverlap::inside : ConeOverlap::border;
}

void SkippableCells::set_bounds(int interval, std::vector<MacrocellBounds> bounds) {
  bounds_.at(static_cast<std::size_t>(interval)) = std::move(bounds);
}

void SkippableCells::set_view(const RenderOptions& options) {
  camera_ = make_camera(options);
  const bool perspective = camera_.projection == Projection::perspective;
  const double half_diagonal_m = camera_.width_m / std::sqrt(2.0);
  spread_ = perspective ? half_diagonal_m / camera_.eye_distance_m : 0;
  may_return_ = rays_may_return();
}

/// Whether a ray of the view may leave the cone of valid data and come back into it. None does if
/// all of them run away from the wobble axis, or all towards it, and so little along x that along
/// them depth tan(half the sector) - |x| and r never turn round.
bool SkippableCells::rays_may_return() const {
  const double half_rad = geometry_.half_sector_rad();
  if (half_rad >= 0.49 * kPi) return true;
  const double steepest = std::min(std::tan(half_rad), 1 / std::tan(half_rad));
  bool away = true, towards = true;
  for (int interval = 0; interval < grid_.intervals; ++interval) {
    const Directions along = directions(interval, 0);
    const double sideways = std::max(-along.x.low, along.x.high) + 1e-6;
    away = away && along.radial.low * steepest >= sideways;
    towards = towards && -along.radial.high * steepest >= sideways;
  }
  return !away && !towards;
}

/// Directions of rays within an interval widened by this angle on both sides.
SkippableCells::Directions SkippableCells::directions(int interval, double margin_rad) const {
  const double phi_rad = (interval + 0.5 - geometry_.frame_at(0)) * phi_step_rad_;
  const double half_rad = (geometry_.is_skewed() ? 1.0 : 0.5) * phi_step_rad_;
  const double spread = spread_ + half_rad + margin_rad;
  const auto around = [](double middle, double margin) {
    return Range{std::max(middle - margin, -1.0), std::min(middle + margin, 1.0)};
  };
  const glm::dvec3& forward = camera_.forward;
  const double radial = forward.z * std::cos(phi_rad) - forward.y * std::sin(phi_rad);
  const double tangential = -forward.y * std::cos(phi_rad) - forward.z * std::sin(phi_rad);
  return {around(forward.x, spread_), around(radial, spread), around(tangential, spread)};
}

/// Largest slope along a ray in a cell, for edges of the sign to be detected.
double SkippableCells::max_edge_slope_per_m(const MacrocellBounds& bounds,
                                            const Directions& along,
                                            double axis_distance_m) const {
  const auto max_change = [&](const Range& component, const ChangeBounds& change) {
    return rising_ ? max_product(component.low, component.high, change.fall, change.rise)
                   : max_product(component.low, component.high, change.rise, change.fall);
  };
  const double frame_m = axis_distance_m * phi_step_rad_;
  const double skew =
      std::abs(geometry_.frame_skew(1)) * frame_m / (axis_distance_m + geometry_.axis_z_m());
  const Range tangential = {along.tangential.low - skew, along.tangential.high + skew};
  return max_change(along.x, bounds.x) / pixel_x_m_ +
         max_change(along.radial, bounds.depth) / pixel_depth_m_ +
         max_change(tangential, bounds.frame) / frame_m;
}

bool SkippableCells::is_visible(float low, float high) const {
  const float rounding = 1.0f / kTransferTableSize;
  return next_visible_[static_cast<std::size_t>(clamped_entry(low - rounding))] <=
         clamped_entry(high + rounding) + 1;
}

bool SkippableCells::may_hold_surface(const MacrocellBounds& bounds,
                                      const Directions& along,
                                      double axis_distance_m) const {
  if (detector_ == Detector::floor) {  // no mean rises so far above another unless a sample does
    return static_cast<double>(bounds.high) >= level_ - value_rounding_;
  }
  if (detector_ == Detector::iso) {
    return rising_ ? static_cast<double>(bounds.high) >= level_ - value_rounding_
                   : static_cast<double>(bounds.low) <= level_ + value_rounding_;
  }
  return max_edge_slope_per_m(bounds, along, axis_distance_m) >= max_slope_without_edge_per_m_;
}

/// Cells whose samples depend on one of `bits`: those within its reach downstream and around it.
CellBits SkippableCells::dilated(const CellBits& bits, const Reach& reach) const {
  const int rows = grid_.rows, intervals = grid_.intervals;
  const double cell_x_m = pixel_x_m_ * grid_.cell_pixels;
  const double cell_depth_m = pixel_depth_m_ * grid_.cell_pixels;
  // Extents upstream along an axis, as lengths in its positive and negative direction.
  const auto upstream = [&](const Range& component) {
    return std::pair(std::max(-component.low, 0.0) * reach.upstream_m + reach.around_m,
                     std::max(component.high, 0.0) * reach.upstream_m + reach.around_m);
  };
  CellBits dilated_bits(bits.size(), 0);
  parallel_rows(intervals, [&](int interval) {
    for (int row = 0; row < rows; ++row) {
      const double distance_m = axis_distance_m(row), length_m = reach.upstream_m + reach.around_m;
      const double nearest_m = std::max(distance_m - length_m, 1e-3 * distance_m);
      const Directions along = directions(interval, turn_rad(length_m, distance_m));
      const auto [right_m, left_m] = upstream(along.x);
      const auto [farther_m, nearer_m] = upstream(along.radial);
      const auto [after_m, before_m] = upstream(along.tangential);
      const double frame_m = nearest_m * phi_step_rad_;
      const double skewed =
          std::abs(geometry_.frame_skew(1)) * turn_rad(length_m, geometry_.r_min_m());
      const int first_row = std::max(row - whole_cells(nearer_m / cell_depth_m), 0);
      const int last_row = std::min(row + whole_cells(farther_m / cell_depth_m), rows - 1);
      const int first = std::max(interval - whole_cells(before_m / frame_m + skewed), 0);
      const int last = std::min(interval + whole_cells(after_m / frame_m + skewed), intervals - 1);
      std::uint64_t row_bits = 0;
      for (int k = first; k <= last; ++k) {
        for (int j = first_row; j <= last_row; ++j) {
          row_bits |= bits[static_cast<std::size_t>(k * rows + j)];
        }
      }
      dilated_bits[static_cast<std::size_t>(interval * rows + row)] =
          dilated_columns(
              row_bits, whole_cells(right_m / cell_x_m), whole_cells(left_m / cell_x_m)) &
          column_mask(grid_);
    }
  });
  return dilated_bits;
}

/// Sets the bits of a row of cells.
void SkippableCells::classify(int interval, int row, Classes& classes) const {
  const auto word = static_cast<std::size_t>(interval * grid_.rows + row);
  const auto row_begin = static_cast<std::size_t>(row) * static_cast<std::size_t>(grid_.columns);
  const MacrocellBounds* row_bounds =
      bounds_[static_cast<std::size_t>(interval)].data() + row_begin;
  const Directions along = directions(interval, 0);
  const bool outermost = interval <= covered_.first || interval + 1 >= covered_.last;
  for (int column = 0; column < grid_.columns; ++column) {
    const std::uint64_t bit = std::uint64_t{1} << column;
    const ConeOverlap overlap = overlaps_[row_begin + static_cast<std::size_t>(column)];
    if (overlap == ConeOverlap::outside) continue;
    const MacrocellBounds& cell = row_bounds[column];
    if (overlap == ConeOverlap::border && may_return_) classes.border[word] |= bit;
    // If some taps of a kernel lie outside the cone, its mean can change faster than the values.
    const bool cut_kernel = kernel_.around_m > 0 && (outermost || overlap == ConeOverlap::border);
    if (detects_ && (cut_kernel || may_hold_surface(cell, along, axis_distance_m(row)))) {
      classes.steep[word] |= bit;
    }
    if (static_cast<double>(cell.high) >= least_bright_value_) classes.bright[word] |= bit;
    if (is_visible(cell.low, cell.high)) classes.visible[word] |= bit;
  }
}

CellBits SkippableCells::to_sample() const {
  const std::size_t words =
      static_cast<std::size_t>(grid_.rows) * static_cast<std::size_t>(grid_.intervals);
  if (!can_leap_) return CellBits(words, column_mask(grid_));
  const CellBits none(words, 0);
  Classes cells{none, none, none, none};
  parallel_rows(grid_.intervals, [&](int interval) {
    for (int row = 0; row < grid_.rows; ++row) classify(interval, row, cells);
  });
  cells.steep = dilated(cells.steep, buffer_);
  if (detector_ == Detector::paper && least_bright_value_ > 0) {
    cells.bright = dilated(cells.bright, buffer_);
    for (std::size_t word = 0; word < words; ++word) cells.steep[word] &= cells.bright[word];
  }
  cells.visible = dilated(cells.visible, kernel_);
  for (std::size_t word = 0; word < words; ++word) {
    cells.border[word] |= cells.steep[word] | cells.visible[word];
  }
  return cells.border;
}

MacrocellGrid make_macrocell_grid(const SliceGeometry& geometry, const Region& pixels) {
  const auto cells = [](int count, int side) { return (count + side - 1) / side; };
  MacrocellGrid grid;
  grid.pixels = pixels;
  grid.cell_pixels = std::max(kMinCellPixels, cells(pixels.columns, kMaxColumns));
  grid.columns = cells(pixels.columns, grid.cell_pixels);
  grid.rows = cells(pixels.rows, grid.cell_pixels);
  grid.intervals = std::max(geometry.frames() - 1, 1);
  return grid;
}

std::uint64_t column_mask(const MacrocellGrid& grid) {
  return ~std::uint64_t{0} >> (kMaxColumns - grid.columns);
}

std::uint64_t dilated_columns(std::uint64_t bits, int down, int up) {
  std::uint64_t all = bits;
  for (int i = 1; i <= std::min(down, kMaxColumns - 1); ++i) all |= bits >> i;
  for (int i = 1; i <= std::min(up, kMaxColumns - 1); ++i) all |= bits << i;
  return all;
}

std::vector<std::uint8_t> cell_distances(const CellBits& set, const MacrocellGrid& grid) {
  const auto columns = static_cast<std::size_t>(grid.columns);
  std::vector<std::uint8_t> distances(columns * set.size(), kMaxCellDistance);
  const auto mark = [&](std::size_t word, std::uint64_t bits, int distance) {
    for (; bits != 0; bits &= bits - 1) {
      distances[word * columns + static_cast<std::size_t>(std::countr_zero(bits))] =
          static_cast<std::uint8_t>(distance);
    }
  };
  CellBits reached = set;
  for (std::size_t word = 0; word < reached.size(); ++word) mark(word, reached[word], 0);
  for (int distance = 1; distance < kMaxCellDistance; ++distance) {
    CellBits next = dilated_by_one(reached, grid);
    if (next == reached) break;
    for (std::size_t word = 0; word < next.size(); ++word) {
      mark(word, next[word] & ~reached[word], distance);
    }
    reached = std::move(next);
  }
  return distances;
}

}  // namespace wobblebench::render
