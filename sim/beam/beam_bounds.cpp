#include "sim/beam/beam_bounds.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <limits>

namespace wobblebench::sim {

namespace {

constexpr double kStep_m = 1e-3;  // of the tube's widths
/// Tissue that turns in itself may stretch a parcel's diagonal by this much.
constexpr double kMostStretch = 1.5;

/// Half the extent of a parcel along one direction of the beam.
double half_extent(const glm::dmat3& turn, int row, double side_m) {
  return 0.5 * side_m * (std::abs(turn[0][row]) + std::abs(turn[1][row]) + std::abs(turn[2][row]));
}

/// Does a body at `center`, with these half extents, touch the tube at its range?
bool touches(const BeamBounds::Reach& reach,
             const glm::dvec3& center,
             double half_lateral_m,
             double half_elevation_m) {
  // Over the reach in both directions, but without dividing.
  const double u = std::max(0.0, std::abs(center.y) - half_lateral_m) * reach.elevation_m;
  const double v = std::max(0.0, std::abs(center.z) - half_elevation_m) * reach.lateral_m;
  const double rim = reach.lateral_m * reach.elevation_m;
  return u * u + v * v < rim * rim;
}

/// Parcels of one map, layer by layer across the axis of the lattice that the stick is nearest to.
class LayerWalk {
 public:
  LayerWalk(const StickView& view, const BeamBounds& tube, const ParcelGrid& lattice, double end_m)
      : map_(view.map()), tube_(tube), lattice_(lattice), end_m_(end_m) {
    begin_ = view.to_rest(glm::dvec3(0));
    direction_ = view.to_rest(glm::dvec3(1, 0, 0)) - begin_;
    const glm::dvec3 speed = glm::abs(direction_);
    across_ = speed.x > speed.y ? (speed.x > speed.z ? 0 : 2) : (speed.y > speed.z ? 1 : 2);
    first_ = (across_ + 1) % 3;
    second_ = (across_ + 2) % 3;
    for (int row = 0; row < 3; ++row) half_[row] = half_extent(map_.turn, row, lattice.side_m);
  }

  void collect(std::vector<TouchedParcel>& touched) {
    const Extent most = extent(tube_.widest());
    // How far from where the axis passes a layer its parcels may lie along the beam.
    aside_m_ = std::abs(map_.turn[first_][0]) * most.first_m +
               std::abs(map_.turn[second_][0]) * most.second_m + half_[0];
    const double from = begin_[across_] - aside_m_ * direction_[across_];
    const double to = begin_[across_] + (end_m_ + aside_m_) * direction_[across_];
    const int low = std::max(index_of(std::min(from, to), across_), lattice_.first[across_]);
    const int high = std::min(index_of(std::max(from, to), across_), lattice_.last[across_]);
    // Nearest first.
    for (int i = 0; i <= high - low; ++i) {
      layer(direction_[across_] > 0 ? low + i : high - i, touched);
    }
  }

 private:
  /// Half sizes of the tube's section by a layer, along the layer's two axes.
  struct Extent {
    double first_m;
    double second_m;
  };

  Extent extent(const BeamBounds::Reach& reach) const {
    // A place of the layer is aside by (u, v) = M (first, second).
    const auto& t = map_.turn;
    const double determinant = t[first_][1] * t[second_][2] - t[second_][1] * t[first_][2];
    const double lateral = reach.lateral_m + half_[1], elevation = reach.elevation_m + half_[2];
    return {std::hypot(t[second_][2] * lateral, t[second_][1] * elevation) / std::abs(determinant),
            std::hypot(t[first_][2] * lateral, t[first_][1] * elevation) / std::abs(determinant)};
  }

  int index_of(double place_m, int axis) const {
    return static_cast<int>(std::floor((place_m - lattice_.origin_m[axis]) / lattice_.side_m));
  }

  BeamBounds::Reach widest_near(double range_m) const {
    const double from = std::max(0.0, range_m - aside_m_),
                 to = std::min(end_m_, range_m + aside_m_);
    BeamBounds::Reach widest = tube_.reach(to);
    const int steps = static_cast<int>(std::ceil((to - from) / kStep_m));
    for (int i = 0; i < steps; ++i) {
      const BeamBounds::Reach& here = tube_.reach(from + i * kStep_m);
      widest.lateral_m = std::max(widest.lateral_m, here.lateral_m);
      widest.elevation_m = std::max(widest.elevation_m, here.elevation_m);
    }
    return widest;
  }

  void layer(int number, std::vector<TouchedParcel>& touched) {
    const double middle = lattice_.origin_m[across_] + (number + 0.5) * lattice_.side_m;
    const double range_m = (middle - begin_[across_]) / direction_[across_];
    const glm::dvec3 axis = begin_ + range_m * direction_;
    const Extent size = extent(widest_near(range_m));
    glm::ivec3 index(0);
    index[across_] = number;
    const auto from = [&](double half_m, int i) {
      return std::max(index_of(axis[i] - half_m, i), lattice_.first[i]);
    };
    const auto to = [&](double half_m, int i) {
      return std::min(index_of(axis[i] + half_m, i), lattice_.last[i]);
    };
    const int from_first = from(size.first_m, first_), last_first = to(size.first_m, first_);
    const int last_second = to(size.second_m, second_);
    const glm::dvec3 step = lattice_.side_m * map_.turn[first_];
    for (int j = from(size.second_m, second_); j <= last_second; ++j) {
      index[second_] = j;
      index[first_] = from_first;
      glm::dvec3 center = map_(lattice_.center(index));
      for (; index[first_] <= last_first; ++index[first_], center += step) {
        if (center.x < -half_[0] || center.x > end_m_ + half_[0]) continue;
        if (!touches(tube_.reach(center.x), center, half_[1], half_[2])) continue;
        // Member by member: moved as a whole, it would be read before all its parts are written.
        TouchedParcel& parcel = touched.emplace_back();
        parcel.index = index;
        parcel.center = center;
      }
    }
  }

  RestToBeam map_;
  const BeamBounds& tube_;
  const ParcelGrid& lattice_;
  double end_m_;
  glm::dvec3 begin_;
  glm::dvec3 direction_;
  int across_;
  int first_;
  int second_;
  double half_[3];
  double aside_m_ = 0;
};

/// Parcels of tissue that turns in itself, slab by slab along the stick: each belongs to the slab
/// that holds its centre.
class SlabWalk {
 public:
  SlabWalk(const StickView& view, const BeamBounds& tube, const ParcelGrid& lattice, double end_m)
      : view_(view),
        tube_(tube),
        lattice_(lattice),
        end_m_(end_m),
        half_m_(0.5 * std::sqrt(3.0) * kMostStretch * lattice.side_m) {
    for (const Turn turn : {Turn::none, Turn::full}) {
      const glm::dmat3& map = view.whole(turn).turn;
      half_[static_cast<std::size_t>(turn)] = {half_extent(map, 1, lattice.side_m),
                                               half_extent(map, 2, lattice.side_m)};
    }
    half_[static_cast<std::size_t>(Turn::partial)] = {half_m_, half_m_};
  }

  void collect(std::vector<TouchedParcel>& touched) const {
    const double thick_m = 2 * lattice_.side_m;
    const int slabs = static_cast<int>(std::ceil((end_m_ + 2 * half_m_) / thick_m));
    for (int i = 0; i < slabs; ++i) {
      slab(i * thick_m - half_m_, (i + 1) * thick_m - half_m_, touched);
    }
  }

 private:
  using Turn = phantoms::Deformation::Turn;

  void slab(double from_m, double to_m, std::vector<TouchedParcel>& touched) const {
    const auto [low, high] = bounds(from_m, to_m);
    for (int z = low.z; z <= high.z; ++z) {
      for (int y = low.y; y <= high.y; ++y) {
        for (int x = low.x; x <= high.x; ++x) {
          const glm::ivec3 index(x, y, z);
          const glm::dvec3 rest_m = lattice_.center(index);
          const Turn turn = view_.turn_within(rest_m, 0.5 * std::sqrt(3.0) * lattice_.side_m);
          const glm::dvec3 center =
              turn == Turn::partial ? view_.to_beam(rest_m) : view_.whole(turn)(rest_m);
          if (center.x < from_m || center.x >= to_m) continue;
          if (center.x > end_m_ + half_m_) continue;
          const BeamBounds::Reach& half = half_[static_cast<std::size_t>(turn)];
          if (touches(tube_.reach(center.x), center, half.lateral_m, half.elevation_m)) {
            touched.push_back({index, center});
          }
        }
      }
    }
  }

  struct Bounds {
    glm::ivec3 low;
    glm::ivec3 high;
  };

  /// Of what lies in a slab, found at points no farther apart than two parcels.
  Bounds bounds(double from_m, double to_m) const {
    const BeamBounds::Reach& a = tube_.reach(from_m);
    const BeamBounds::Reach& b = tube_.reach(to_m);
    const double lateral = std::max(a.lateral_m, b.lateral_m) + half_m_;
    const double elevation = std::max(a.elevation_m, b.elevation_m) + half_m_;
    const double step = 2 * lattice_.side_m;
    const int across = static_cast<int>(std::ceil(2 * lateral / step));
    const int along = static_cast<int>(std::ceil(2 * elevation / step));
    glm::dvec3 low(std::numeric_limits<double>::infinity()), high = -low;
    for (int i = 0; i <= across; ++i) {
      for (int j = 0; j <= along; ++j) {
        for (const double range : {from_m, to_m}) {
          const glm::dvec3 at = view_.to_rest(
              {range, lateral * (2.0 * i / across - 1), elevation * (2.0 * j / along - 1)});
          low = glm::min(low, at);
          high = glm::max(high, at);
        }
      }
    }
    // Between the points tissue may bulge by less than a parcel.
    const auto index = [&](const glm::dvec3& at) {
      return glm::ivec3(glm::floor((at - lattice_.origin_m) / lattice_.side_m));
    };
    return {glm::max(index(low) - 1, lattice_.first), glm::min(index(high) + 1, lattice_.last)};
  }

  const StickView& view_;
  const BeamBounds& tube_;
  const ParcelGrid& lattice_;
  double end_m_;
  double half_m_;
  BeamBounds::Reach half_[3];  ///< half extents of a parcel across the stick, by how it moves
};

}  // namespace

StickView::StickView(const ScannedTissue& subject, const Sightline& line)
    : subject_(subject),
      ray_(line.ray),
      across_(across_stick(line.ray)),
      moment_(subject.motion.at(line.time_s)),
      rigid_(subject.motion.rigid()) {
  for (const auto turn : {phantoms::Deformation::Turn::none, phantoms::Deformation::Turn::full}) {
    whole_[static_cast<std::size_t>(turn)] = seen(moment_.tangent_of(turn), glm::dvec3(0));
  }
}

glm::dvec3 StickView::to_beam(const glm::dvec3& rest_m) const {
  const glm::dvec3 from_face = subject_.placement.to_probe(moment_.from_rest(rest_m)) - ray_.origin;
  return {glm::dot(ray_.direction, from_face),
          glm::dot(across_.lateral, from_face),
          glm::dot(across_.elevation, from_face)};
}

glm::dvec3 StickView::to_rest(const glm::dvec3& beam_m) const {
  const glm::dvec3 probe_m =
      ray_.at(beam_m.x) + beam_m.y * across_.lateral + beam_m.z * across_.elevation;
  return moment_.to_rest(subject_.placement.to_phantom(probe_m));
}

RestToBeam StickView::seen(const phantoms::Deformation::Tangent& tangent,
                           const glm::dvec3& rest_m) const {
  const auto beam = [&](const glm::dvec3& v) {
    return glm::dvec3(
        glm::dot(ray_.direction, v), glm::dot(across_.lateral, v), glm::dot(across_.elevation, v));
  };
  const glm::dvec3 origin = subject_.placement.to_probe(glm::dvec3(0));
  RestToBeam map;
  for (int axis = 0; axis < 3; ++axis) {
    map.turn[axis] = beam(subject_.placement.to_probe(tangent.jacobian[axis]) - origin);
  }
  map.shift = beam(subject_.placement.to_probe(tangent.position_m) - ray_.origin) - map.turn * rest_m;
  return map;
}

RestToBeam StickView::map_near(const glm::dvec3& rest_m) const {
  return seen(moment_.tangent(rest_m), rest_m);
}

BeamBounds::BeamBounds(const BeamTable& table, double depth_m, double margin_m)
    : per_m_(1 / kStep_m) {
  const int count = static_cast<int>(std::ceil(depth_m * per_m_)) + 1;
  const int window = static_cast<int>(std::ceil(margin_m * per_m_)) + 1;
  for (int i = 0; i < count; ++i) {
    Reach reach{0, 0};
    const int last = table.row((i + window) * kStep_m);
    for (int row = table.row((i - window) * kStep_m); row <= last; ++row) {
      reach.lateral_m = std::max(reach.lateral_m, table.reach_m(table.lateral(), row));
      reach.elevation_m = std::max(reach.elevation_m, table.reach_m(table.elevation(), row));
    }
    reach_.push_back(reach);
    widest_.lateral_m = std::max(widest_.lateral_m, reach.lateral_m);
    widest_.elevation_m = std::max(widest_.elevation_m, reach.elevation_m);
  }
}

const BeamBounds::Reach& BeamBounds::reach(double range_m) const {
  const int i = static_cast<int>(range_m * per_m_);
  return reach_[static_cast<std::size_t>(std::clamp(i, 0, static_cast<int>(reach_.size()) - 1))];
}

void find_touched(const StickView& view,
                  const BeamBounds& tube,
                  const ParcelGrid& lattice,
                  double end_m,
                  std::vector<TouchedParcel>& touched) {
  touched.clear();
  if (view.rigid()) {
    LayerWalk(view, tube, lattice, end_m).collect(touched);
  } else {
    SlabWalk(view, tube, lattice, end_m).collect(touched);
  }
}

}  // namespace wobblebench::sim
