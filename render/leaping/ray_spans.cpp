#include "render/leaping/ray_spans.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <glm/geometric.hpp>

#include "base/parallel.h"

namespace wobblebench::render {
namespace {

/// Numbers between two bounds.
struct Interval {
  double low = 0, high = 0;

  static Interval of(double one, double other) {
    return {std::min(one, other), std::max(one, other)};
  }
  Interval operator+(const Interval& other) const { return {low + other.low, high + other.high}; }
  Interval scaled(double factor) const { return of(low * factor, high * factor); }
  Interval widened(double by) const { return {low - by, high + by}; }
  Interval united(const Interval& other) const {
    return {std::min(low, other.low), std::max(high, other.high)};
  }
  /// Of magnitudes.
  Interval squared() const {
    const double least = std::max({low, -high, 0.0}), most = std::max(-low, high);
    return {least * least, most * most};
  }
};

/// A box along the picture's axes, from the box's centre or the eye on: `right`, `down`, `forward`.
using Box = std::array<Interval, 3>;

Box operator+(const Box& a, const Box& b) {
  return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}

/// The boxes of a grid's cells, each the sum of what its columns and what its row and interval add.
class CellBoxes {
 public:
  CellBoxes(const MacrocellGrid& grid, const SliceGeometry& geometry, const Camera& camera)
      : grid_(grid), geometry_(geometry), axes_{camera.right, camera.down, camera.forward} {
    const bool parallel = camera.projection == Projection::parallel;
    const double back_m = parallel ? camera.plane_distance_m : camera.eye_distance_m;
    origin_m_ = camera.center - back_m * camera.forward;
    skew_frames_ = std::abs(geometry.frame_skew(1)) * geometry.half_sector_rad();
    for (int column = 0; column < grid.columns; ++column) columns_.push_back(of_column(column));
  }

  const Box& column(int column) const { return columns_[static_cast<std::size_t>(column)]; }

  Box row(int interval, int row) const {
    const double near_m = radius_m(row), far_m = radius_m(row + 1);
    const double first_rad = phi_rad(interval - skew_frames_);
    const double last_rad = phi_rad(interval + 1 + skew_frames_);
    const std::array<glm::dvec3, 4> corners = {position(near_m, first_rad),
                                               position(near_m, last_rad),
                                               position(far_m, first_rad),
                                               position(far_m, last_rad)};
    // Between its corners the far side bulges by the height of its arc.
    const double bulge_m = far_m * (1 - std::cos(0.5 * (last_rad - first_rad)));
    Box box;
    for (std::size_t axis = 0; axis < box.size(); ++axis) {
      const auto along = [&](const glm::dvec3& corner) { return glm::dot(corner, axes_[axis]); };
      const Interval near = Interval::of(along(corners[0]), along(corners[1]));
      const Interval far = Interval::of(along(corners[2]), along(corners[3]));
      box[axis] = near.united(far).widened(bulge_m);
    }
    return box;
  }

 private:
  Box of_column(int column) const {
    const double first = grid_.pixels.column + column * grid_.cell_pixels - 0.5;
    Box box;
    for (std::size_t axis = 0; axis < box.size(); ++axis) {
      box[axis] = Interval::of(geometry_.pixel_x_m(first) * axes_[axis].x,
                               geometry_.pixel_x_m(first + grid_.cell_pixels) * axes_[axis].x);
    }
    return box;
  }
  double radius_m(int row) const {
    const double first = grid_.pixels.row + row * grid_.cell_pixels - 0.5;
    return geometry_.pixel_depth_m(first) - geometry_.axis_z_m();
  }
  double phi_rad(double frame) const {
    const double middle = geometry_.frame_at(0);
    return (frame - middle) / (geometry_.frame_at(1) - middle);
  }
  /// At x = 0, from the rays' origin.
  glm::dvec3 position(double radius_m, double phi_rad) const {
    return glm::dvec3(0,
                      -radius_m * std::sin(phi_rad),
                      geometry_.axis_z_m() + radius_m * std::cos(phi_rad)) -
           origin_m_;
  }

  MacrocellGrid grid_;
  const SliceGeometry& geometry_;
  std::array<glm::dvec3, 3> axes_;
  glm::dvec3 origin_m_{0};
  double skew_frames_ = 0;
  std::vector<Box> columns_;
};

/// The spans of a picture's tiles, to which boxes are added.
class Tiles {
 public:
  explicit Tiles(const Camera& camera) : camera_(camera), side_(tiles_per_side(camera.image_size)) {
    spans_.assign(static_cast<std::size_t>(side_) * static_cast<std::size_t>(side_),
                  {1e30f, -1.0f});
  }

  void add(const Box& box) {
    if (camera_.projection == Projection::parallel) {
      add(box[0], box[1], box[2]);
      return;
    }
    const Interval& ahead = box[2];
    const Interval squares = box[0].squared() + box[1].squared() + ahead.squared();
    const Interval length_m{std::sqrt(squares.low), std::sqrt(squares.high)};
    if (ahead.low <= 0.01 * camera_.eye_distance_m) {  // beside or behind the eye
      const Interval everywhere{-camera_.width_m, camera_.width_m};
      add(everywhere, everywhere, length_m);
      return;
    }
    const auto on_plane = [&](const Interval& offset) {
      const Interval at_near = offset.scaled(camera_.eye_distance_m / ahead.low);
      return at_near.united(offset.scaled(camera_.eye_distance_m / ahead.high));
    };
    add(on_plane(box[0]), on_plane(box[1]), length_m);
  }

  void unite(const Tiles& other) {
    for (std::size_t i = 0; i < spans_.size(); ++i) {
      spans_[i] = {std::min(spans_[i][0], other.spans_[i][0]),
                   std::max(spans_[i][1], other.spans_[i][1])};
    }
  }

  std::vector<float> values() const {
    std::vector<float> all;
    for (const auto& span : spans_) all.insert(all.end(), span.begin(), span.end());
    return all;
  }

 private:
  /// `right` and `down`: on the view plane, from its middle.
  void add(const Interval& right, const Interval& down, const Interval& length_m) {
    const auto [left, after_right] = tiles_of(right);
    const auto [top, after_bottom] = tiles_of(down);
    const auto first_m = static_cast<float>(length_m.low);
    const auto last_m = static_cast<float>(length_m.high);
    for (int row = top; row < after_bottom; ++row) {
      for (int column = left; column < after_right; ++column) {
        auto& span = spans_[static_cast<std::size_t>(row * side_ + column)];
        span = {std::min(span[0], first_m), std::max(span[1], last_m)};
      }
    }
  }
  /// Tiles with pixels whose centres lie in the interval, first and past the last.
  std::array<int, 2> tiles_of(const Interval& offset) const {
    const double rounding = 0.05;  // of a pixel
    const double half = 0.5 * camera_.image_size - 0.5, last = camera_.image_size - 1;
    const double from = std::ceil(offset.low / camera_.pixel_m() + half - rounding);
    const double to = std::floor(offset.high / camera_.pixel_m() + half + rounding);
    if (from > to || from > last || to < 0) return {0, 0};
    return {static_cast<int>(std::max(from, 0.0)) / kTilePixels,
            static_cast<int>(std::min(to, last)) / kTilePixels + 1};
  }

  const Camera& camera_;
  int side_;
  std::vector<std::array<float, 2>> spans_;  ///< [row][column]
};

}  // namespace

std::vector<float> ray_spans(const CellBits& set,
                             const MacrocellGrid& grid,
                             const SliceGeometry& geometry,
                             const Camera& camera) {
  const CellBoxes boxes(grid, geometry, camera);
  // Each part of the intervals has tiles of its own.
  constexpr int kParts = 4;
  std::vector<Tiles> parts(kParts, Tiles(camera));
  parallel_rows(kParts, [&](int part) {
    Tiles& tiles = parts[static_cast<std::size_t>(part)];
    for (int interval = part; interval < grid.intervals; interval += kParts) {
      for (int row = 0; row < grid.rows; ++row) {
        std::uint64_t cells = set[static_cast<std::size_t>(interval * grid.rows + row)];
        if (cells == 0) continue;
        const Box row_box = boxes.row(interval, row);
        for (; cells != 0; cells &= cells - 1) {
          tiles.add(row_box + boxes.column(std::countr_zero(cells)));
        }
      }
    }
  });
  for (const Tiles& part : parts) parts.front().unite(part);
  return parts.front().values();
}

}  // namespace wobblebench::render
