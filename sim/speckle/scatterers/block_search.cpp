#include "sim/speckle/scatterers/block_search.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/matrix.hpp>
#include <limits>

#include "sim/tissue/scanned_tissue.h"

namespace wobblebench::sim {

namespace {

/// Largest stretch of a block's diagonal by non-rigid motion.
constexpr double kMaxStretch = 1.5;

/// Half the extent of a block along one of the beam's axes.
double half_extent(const glm::dmat3& matrix, int row, double side_m) {
  return 0.5 * side_m *
         (std::abs(matrix[0][row]) + std::abs(matrix[1][row]) + std::abs(matrix[2][row]));
}

/// True if a box at `center`, with these half extents, touches the beam's bounds there.
bool touches(const BeamBounds::Reach& reach,
             const glm::dvec3& center,
             double half_lateral_m,
             double half_elevation_m) {
  // Offsets over the reach in both directions, multiplied out to avoid divisions.
  const double u = std::max(0.0, std::abs(center.y) - half_lateral_m) * reach.elevation_m;
  const double v = std::max(0.0, std::abs(center.z) - half_elevation_m) * reach.lateral_m;
  const double rim = reach.lateral_m * reach.elevation_m;
  return u * u + v * v < rim * rim;
}

using Turn = phantoms::Deformation::Turn;

/// Blocks of tissue that moves by one rigid map, layer by layer along the grid axis nearest to the
/// stick's direction. Those whose centres lie in an interval of ranges, or all.
class RigidBlockSearch {
 public:
  RigidBlockSearch(const StickTransform& transform,
                   Turn turn,
                   const BeamBounds& bounds,
                   const BlockGrid& grid,
                   double end_m)
      : map_(transform.rigid_map(turn)), turn_(turn), bounds_(bounds), grid_(grid), end_m_(end_m) {
    const glm::dmat3 inverse = glm::transpose(map_.matrix);
    begin_ = -(inverse * map_.shift);
    direction_ = inverse[0];
    const glm::dvec3 speed = glm::abs(direction_);
    layer_axis_ = speed.x > speed.y ? (speed.x > speed.z ? 0 : 2) : (speed.y > speed.z ? 1 : 2);
    first_ = (layer_axis_ + 1) % 3;
    second_ = (layer_axis_ + 2) % 3;
    for (int row = 0; row < 3; ++row) half_[row] = half_extent(map_.matrix, row, grid.side_m);
    from_m_ = -half_[0];
    to_m_ = end_m + half_[0];
  }

  void limit(double from_m, double to_m) {
    from_m_ = std::max(from_m_, from_m);
    to_m_ = std::min(to_m_, to_m);
  }

  void collect(std::vector<TouchedBlock>& touched) {
    const Extent most = extent(bounds_.widest());
    // Largest axial distance of a layer's blocks from the stick's crossing of the layer.
    axial_margin_m_ = std::abs(map_.matrix[first_][0]) * most.first_m +
                      std::abs(map_.matrix[second_][0]) * most.second_m + half_[0];
    const double from = begin_[layer_axis_] + (from_m_ - axial_margin_m_) * direction_[layer_axis_];
    const double to = begin_[layer_axis_] + (to_m_ + axial_margin_m_) * direction_[layer_axis_];
    const int low = std::max(index_of(std::min(from, to), layer_axis_), grid_.first[layer_axis_]);
    const int high = std::min(index_of(std::max(from, to), layer_axis_), grid_.last[layer_axis_]);
    // Nearest first.
    for (int i = 0; i <= high - low; ++i) {
      layer(direction_[layer_axis_] > 0 ? low + i : high - i, touched);
    }
  }

 private:
  /// Half extents, along a layer's two axes, of the section of the beam's bounds with the layer.
  struct Extent {
    double first_m;
    double second_m;
  };

  Extent extent(const BeamBounds::Reach& reach) const {
    // Beam offsets in the layer: (lateral, elevation) = M (first, second).
    const auto& t = map_.matrix;
    const double determinant = t[first_][1] * t[second_][2] - t[second_][1] * t[first_][2];
    const double lateral = reach.lateral_m + half_[1], elevation = reach.elevation_m + half_[2];
    return {std::hypot(t[second_][2] * lateral, t[second_][1] * elevation) / std::abs(determinant),
            std::hypot(t[first_][2] * lateral, t[first_][1] * elevation) / std::abs(determinant)};
  }

  int index_of(double position_m, int axis) const {
    return static_cast<int>(std::floor((position_m - grid_.origin_m[axis]) / grid_.side_m));
  }

  BeamBounds::Reach widest_near(double range_m) const {
    const double from = std::max(0.0, range_m - axial_margin_m_),
                 to = std::min(end_m_, range_m + axial_margin_m_);
    BeamBounds::Reach widest = bounds_.reach(to);
    const int steps = static_cast<int>(std::ceil((to - from) / BeamBounds::kStep_m));
    for (int i = 0; i < steps; ++i) {
      const BeamBounds::Reach& here = bounds_.reach(from + i * BeamBounds::kStep_m);
      widest.lateral_m = std::max(widest.lateral_m, here.lateral_m);
      widest.elevation_m = std::max(widest.elevation_m, here.elevation_m);
    }
    return widest;
  }

  void layer(int number, std::vector<TouchedBlock>& touched) {
    const double middle = grid_.origin_m[layer_axis_] + (number + 0.5) * grid_.side_m;
    const double range_m = (middle - begin_[layer_axis_]) / direction_[layer_axis_];
    const glm::dvec3 axis = begin_ + range_m * direction_;
    const Extent size = extent(widest_near(range_m));
    glm::ivec3 index(0);
    index[layer_axis_] = number;
    const auto from = [&](double half_m, int i) {
      return std::max(index_of(axis[i] - half_m, i), grid_.first[i]);
    };
    const auto to = [&](double half_m, int i) {
      return std::min(index_of(axis[i] + half_m, i), grid_.last[i]);
    };
    const int from_first = from(size.first_m, first_), last_first = to(size.first_m, first_);
    const int last_second = to(size.second_m, second_);
    const glm::dvec3 step = grid_.side_m * map_.matrix[first_];
    for (int j = from(size.second_m, second_); j <= last_second; ++j) {
      index[second_] = j;
      index[first_] = from_first;
      glm::dvec3 center = map_(grid_.center(index));
      for (; index[first_] <= last_first; ++index[first_], center += step) {
        if (center.x < from_m_ || center.x >= to_m_) continue;
        if (!touches(bounds_.reach(center.x), center, half_[1], half_[2])) continue;
        // Member by member: copying a struct just built from parts stalls on store forwarding.
        TouchedBlock& block = touched.emplace_back();
        block.index = index;
        block.center = center;
        block.turn = turn_;
      }
    }
  }

  RestToBeam map_;
  Turn turn_;
  const BeamBounds& bounds_;
  const BlockGrid& grid_;
  double end_m_, from_m_, to_m_;
  glm::dvec3 begin_;
  glm::dvec3 direction_;
  int layer_axis_;
  int first_;
  int second_;
  double half_[3];
  double axial_margin_m_ = 0;
};

/// Blocks of tissue that moves non-rigidly, slab by slab along the stick: each belongs to the slab
/// that contains its centre. Slabs of which all tissue moves by one rigid map are searched
/// together.
class NonRigidBlockSearch {
 public:
  NonRigidBlockSearch(const StickTransform& transform,
                      const BeamBounds& bounds,
                      const BlockGrid& grid,
                      double end_m)
      : transform_(transform),
        bounds_(bounds),
        grid_(grid),
        end_m_(end_m),
        half_m_(0.5 * std::sqrt(3.0) * kMaxStretch * grid.side_m) {
    for (const Turn turn : {Turn::none, Turn::full}) {
      const glm::dmat3& map = transform.rigid_map(turn).matrix;
      half_[static_cast<std::size_t>(turn)] = {half_extent(map, 1, grid.side_m),
                                               half_extent(map, 2, grid.side_m)};
    }
    half_[static_cast<std::size_t>(Turn::partial)] = {half_m_, half_m_};
  }

  void collect(std::vector<TouchedBlock>& touched) const {
    const double thick_m = 2 * grid_.side_m;
    const int slabs = static_cast<int>(std::ceil((end_m_ + 2 * half_m_) / thick_m));
    const auto begin_m = [&](int i) { return i * thick_m - half_m_; };
    for (int i = 0; i < slabs;) {
      const Turn turn = turn_of_slab(begin_m(i), begin_m(i + 1));
      int next = i + 1;
      if (turn == Turn::partial) {
        slab(begin_m(i), begin_m(next), touched);
      } else {
        while (next < slabs && turn_of_slab(begin_m(next), begin_m(next + 1)) == turn) ++next;
        RigidBlockSearch search(transform_, turn, bounds_, grid_, end_m_);
        search.limit(begin_m(i), begin_m(next));
        search.collect(touched);
      }
      i = next;
    }
  }

 private:
  /// How all tissue of the blocks of a slab moves. A turn maps balls that move rigidly onto balls.
  Turn turn_of_slab(double from_m, double to_m) const {
    const BeamBounds::Reach reach = reach_in(from_m, to_m);
    const double radius_m =
        std::hypot(0.5 * (to_m - from_m) + half_m_, std::hypot(reach.lateral_m, reach.elevation_m));
    const glm::dvec3 center = transform_.to_rest({0.5 * (from_m + to_m), 0, 0});
    return transform_.turn_within(center, radius_m);
  }

  /// The beam's widest reach in a slab, and half a block.
  BeamBounds::Reach reach_in(double from_m, double to_m) const {
    const BeamBounds::Reach &a = bounds_.reach(from_m), &b = bounds_.reach(to_m);
    return {std::max(a.lateral_m, b.lateral_m) + half_m_,
            std::max(a.elevation_m, b.elevation_m) + half_m_};
  }

  void slab(double from_m, double to_m, std::vector<TouchedBlock>& touched) const {
    const auto [low, high] = index_range(from_m, to_m);
    for (int z = low.z; z <= high.z; ++z) {
      for (int y = low.y; y <= high.y; ++y) {
        for (int x = low.x; x <= high.x; ++x) {
          const glm::ivec3 index(x, y, z);
          const glm::dvec3 rest_m = grid_.center(index);
          const Turn turn = transform_.turn_within(rest_m, 0.5 * std::sqrt(3.0) * grid_.side_m);
          const glm::dvec3 center = turn == Turn::partial ? transform_.to_beam(rest_m)
                                                          : transform_.rigid_map(turn)(rest_m);
          if (center.x < from_m || center.x >= to_m) continue;
          if (center.x > end_m_ + half_m_) continue;
          const BeamBounds::Reach& half = half_[static_cast<std::size_t>(turn)];
          if (touches(bounds_.reach(center.x), center, half.lateral_m, half.elevation_m)) {
            touched.push_back({index, center, turn});
          }
        }
      }
    }
  }

  struct IndexRange {
    glm::ivec3 low;
    glm::ivec3 high;
  };

  /// Block indices in a slab, found from points no farther apart than two blocks.
  IndexRange index_range(double from_m, double to_m) const {
    const auto [lateral, elevation] = reach_in(from_m, to_m);
    const double step = 2 * grid_.side_m;
    const int across = static_cast<int>(std::ceil(2 * lateral / step));
    const int along = static_cast<int>(std::ceil(2 * elevation / step));
    glm::dvec3 low(std::numeric_limits<double>::infinity()), high = -low;
    for (int i = 0; i <= across; ++i) {
      for (int j = 0; j <= along; ++j) {
        for (const double range : {from_m, to_m}) {
          const glm::dvec3 at = transform_.to_rest(
              {range, lateral * (2.0 * i / across - 1), elevation * (2.0 * j / along - 1)});
          low = glm::min(low, at);
          high = glm::max(high, at);
        }
      }
    }
    // Between the points the slab's image at rest may bulge by less than a block.
    const auto index = [&](const glm::dvec3& at) {
      return glm::ivec3(glm::floor((at - grid_.origin_m) / grid_.side_m));
    };
    return {glm::max(index(low) - 1, grid_.first), glm::min(index(high) + 1, grid_.last)};
  }

  const StickTransform& transform_;
  const BeamBounds& bounds_;
  const BlockGrid& grid_;
  double end_m_;
  double half_m_;
  BeamBounds::Reach half_[3];  ///< half extents of a block across the stick, by how it moves
};

}  // namespace

void find_touched_blocks(const StickTransform& transform,
                         const BeamBounds& bounds,
                         const BlockGrid& grid,
                         double end_m,
                         std::vector<TouchedBlock>& touched) {
  touched.clear();
  if (transform.rigid()) {
    RigidBlockSearch(transform, Turn::none, bounds, grid, end_m).collect(touched);
  } else {
    NonRigidBlockSearch(transform, bounds, grid, end_m).collect(touched);
  }
}

}  // namespace wobblebench::sim
