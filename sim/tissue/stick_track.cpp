#include "sim/tissue/stick_track.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

#include "sim/tissue/scanned_tissue.h"

namespace wobblebench::sim {

namespace {

/// Node intervals per step of the map, in crossed cells and in other cells. In crossed cells they
/// are short enough for distances to be nearly linear within each; in other cells the beam's
/// average over the surface varies slowly.
constexpr double kCrossed = 1.5, kUncrossed = 0.75;
/// Reserved number of cells along a stick.
constexpr std::size_t kVisits = 256;
/// Bound of the error in distances due to rounding of positions within a cell.
constexpr float kOnWall_m = 1e-8f;
/// Length of the straight pieces into which a stick is divided, in the rest frame, where tissue
/// moves non-rigidly.
constexpr double kNonRigidPiece_m = 2e-3;

/// A piece of the stick that is straight in the rest frame.
struct Straight {
  double from_m;
  double to_m;
  glm::dvec3 origin;     ///< at from_m
  glm::dvec3 direction;  ///< metres at rest for each metre of range
  AcrossStick across;

  glm::dvec3 at(double range_m) const { return origin + (range_m - from_m) * direction; }
};

Straight straight(const ScannedTissue& tissue,
                  const phantoms::Deformation& moment,
                  const TimedRay& line,
                  double from_m,
                  double to_m) {
  const auto rest = [&](const glm::dvec3& probe_m) {
    return moment.to_rest(tissue.placement.to_phantom(probe_m));
  };
  const glm::dvec3 begin = rest(line.ray.at(from_m)), end = rest(line.ray.at(to_m));
  const AcrossStick across = across_stick(line.ray);
  constexpr double kAside_m = 1e-3;
  return {from_m,
          to_m,
          begin,
          (end - begin) / (to_m - from_m),
          {(rest(line.ray.at(from_m) + kAside_m * across.lateral) - begin) / kAside_m,
           (rest(line.ray.at(from_m) + kAside_m * across.elevation) - begin) / kAside_m}};
}

/// Grid traversal by a digital differential analyser: the cells of a tissue map along a straight
/// line (Amanatides and Woo 1987).
class GridDda {
 public:
  /// Along the line from range `from_m` at `origin` (rest frame) to range `to_m`. `direction`:
  /// metres at rest for each metre of range.
  GridDda(const TissueMap& map,
          const glm::dvec3& origin,
          const glm::dvec3& direction,
          double from_m,
          double to_m)
      : cell_(map.cell_at(origin)), range_m_(from_m), end_m_(to_m) {
    for (int axis = 0; axis < 3; ++axis) {
      const double speed = direction[axis];
      step_[axis] = speed < 0 ? -1 : 1;
      const double wall = map.origin_m()[axis] + (cell_[axis] + (speed < 0 ? 0 : 1)) * map.cell_m();
      const double never = std::numeric_limits<double>::infinity();
      next_[axis] = speed == 0 ? never : from_m + std::max(0.0, (wall - origin[axis]) / speed);
      stride_[axis] = speed == 0 ? never : map.cell_m() / std::abs(speed);
    }
  }

  bool done() const { return range_m_ >= end_m_; }
  const glm::ivec3& cell() const { return cell_; }
  /// Ranges at which the line enters and leaves the cell.
  double from_m() const { return range_m_; }
  double to_m() const { return std::min(end_m_, next_[nearest()]); }

  void advance() {
    const int axis = nearest();
    range_m_ = next_[axis];
    cell_[axis] += step_[axis];
    next_[axis] += stride_[axis];
  }

 private:
  int nearest() const {
    if (next_.x <= next_.y) return next_.x <= next_.z ? 0 : 2;
    return next_.y <= next_.z ? 1 : 2;
  }

  glm::ivec3 cell_;
  glm::ivec3 step_{0};
  glm::dvec3 next_{0};
  glm::dvec3 stride_{0};
  double range_m_;
  double end_m_;
};

class TrackBuilder {
 public:
  TrackBuilder(const ScannedTissue& tissue, Surfaces surfaces, StickTrack& track)
      : map_(*tissue.map), surfaces_(surfaces), track_(track) {
    visits_.reserve(kVisits);
  }

  void append(const Straight& piece) {
    find_cells(piece);
    line_.axial = glm::vec3(piece.direction);
    line_.lateral = glm::vec3(piece.across.lateral);
    line_.elevation = glm::vec3(piece.across.elevation);
    for (const Visit& visit : visits_) {
      if (visit.cell->count == 0 || (surfaces_ == Surfaces::crossed && is_uncrossed(*visit.cell))) {
        pass_clear(visit.from_m, visit.to_m, visit.cell->material);
      } else {
        pass_surfaces(piece, visit);
      }
    }
  }

  void finish(double depth_m) {
    if (!track_.stretches.empty()) track_.stretches.back().to_m = depth_m;
  }

 private:
  /// A cell, and the section of the stick in it.
  struct Visit {
    const TissueMap::Cell* cell = nullptr;
    glm::ivec3 index{0};
    double from_m = 0;
    double to_m = 0;
  };

  /// Lists all cells of a piece before any is read, so that their contents can be prefetched
  /// together.
  void find_cells(const Straight& piece) {
    visits_.clear();
    for (GridDda dda(map_, piece.origin, piece.direction, piece.from_m, piece.to_m); !dda.done();
         dda.advance()) {
      const double from = dda.from_m(), to = dda.to_m();
      if (to <= from) continue;
      // Member by member: copying a struct just built from parts stalls on store forwarding.
      Visit& visit = visits_.emplace_back();
      visit.cell = &map_.cell(dda.cell());
      visit.index = dda.cell();
      visit.from_m = from;
      visit.to_m = to;
      __builtin_prefetch(visit.cell);
    }
    for (const Visit& visit : visits_) map_.prefetch(*visit.cell);
    for (const Visit& visit : visits_) {
      if (surfaces_ == Surfaces::crossed && !visit.cell->crossed) continue;
      for (const TissueMap::Entry& entry : map_.entries(*visit.cell)) map_.prefetch(entry);
    }
  }

  /// True if no surface crosses the cell and the material does not change on entering it.
  bool is_uncrossed(const TissueMap::Cell& cell) const {
    return !cell.crossed && cell.material == current();
  }

  void pass_clear(double from, double to, phantoms::MaterialIndex base) {
    auto& pieces = track_.pieces;
    if (!pieces.empty() && pieces.back().layers == 0 && pieces.back().base == base) {
      pieces.back().to_m = to;
    } else {
      add_piece(from, to, base, 0, 0);
    }
    enter(from, base, 1.0);
  }

  /// Member by member, as in find_cells().
  void add_piece(double from, double to, phantoms::MaterialIndex base, int layers, int nodes) {
    TrackPiece& piece = track_.pieces.emplace_back();
    piece.from_m = from;
    piece.to_m = to;
    piece.base = base;
    piece.first_layer = static_cast<int>(track_.layers.size());
    piece.layers = layers;
    piece.nodes = nodes;
  }

  void pass_surfaces(const Straight& piece, const Visit& visit) {
    const TissueMap::Cell& cell = *visit.cell;
    const double from = visit.from_m, to = visit.to_m;
    const double cells = (to - from) / map_.cell_m();
    const double steps = (to - from) / map_.step_m();
    const int intervals = 1 + static_cast<int>(steps * (cell.crossed ? kCrossed : kUncrossed));
    const int nodes = intervals + 1;
    add_piece(from, to, cell.base, cell.count, nodes);
    const glm::dvec3 low = map_.origin_m() + map_.cell_m() * glm::dvec3(visit.index);
    line_.begin = glm::vec3((piece.at(from) - low) / map_.cell_m());
    line_.stride = static_cast<float>(cells / intervals) * line_.axial;
    for (const TissueMap::Entry& entry : map_.entries(cell)) {
      const std::size_t before = track_.nodes.size();
      TrackLayer& layer = track_.layers.emplace_back();
      layer.surface = entry.surface;
      layer.inside = entry.inside;
      layer.first_node = static_cast<int>(before);
      track_.nodes.resize(before + static_cast<std::size_t>(nodes));
      map_.trace(entry, line_, nodes, track_.nodes.data() + before);
    }
    if (!is_uncrossed(cell)) add_interfaces(piece, track_.pieces.back());
  }

  const TrackNode& node(const TrackPiece& piece, int layer, int n) const {
    const auto& found = track_.layers[static_cast<std::size_t>(piece.first_layer + layer)];
    return track_.nodes[static_cast<std::size_t>(found.first_node + n)];
  }

  phantoms::MaterialIndex material(const TrackPiece& piece, int n) const {
    for (int layer = piece.layers - 1; layer >= 0; --layer) {
      if (node(piece, layer, n).value_m >= 0) continue;
      return track_.layers[static_cast<std::size_t>(piece.first_layer + layer)].inside;
    }
    return piece.base;
  }

  void add_interfaces(const Straight& line, const TrackPiece& piece) {
    const double step = (piece.to_m - piece.from_m) / (piece.nodes - 1);
    const auto cosine = [&](int layer, double range_m) {
      const auto& found = track_.layers[static_cast<std::size_t>(piece.first_layer + layer)];
      const glm::dvec3 normal = map_.normal(found.surface, line.at(range_m));
      return std::min(1.0, std::abs(glm::dot(normal, glm::normalize(line.direction))));
    };
    if (material(piece, 0) != current() && !only_touches(piece)) {
      enter(piece.from_m, material(piece, 0), cosine(nearest_surface(piece, 0), piece.from_m));
    }
    if (keeps_sides(piece)) return;
    for (int n = 1; n < piece.nodes; ++n) {
      const auto behind = material(piece, n);
      if (behind == current()) continue;
      const Crossing found = crossing(piece, n - 1);
      const double range_m = piece.from_m + (n - 1 + found.share) * step;
      enter(range_m, behind, cosine(found.layer, range_m));
    }
  }

  /// True if a surface lies on the wall through which the stick enters the cell. It has been
  /// crossed before the wall; only rounding puts the first node on its near side again.
  bool only_touches(const TrackPiece& piece) const {
    const float value_m = node(piece, nearest_surface(piece, 0), 0).value_m;
    return std::abs(value_m) < kOnWall_m && material(piece, 1) == current();
  }

  /// True if the stick crosses none of the piece's surfaces.
  bool keeps_sides(const TrackPiece& piece) const {
    for (int layer = 0; layer < piece.layers; ++layer) {
      const TrackNode* nodes = &node(piece, layer, 0);
      const auto inside =
          std::count_if(nodes, nodes + piece.nodes, [](const auto& at) { return at.value_m < 0; });
      if (inside != 0 && inside != piece.nodes) return false;
    }
    return true;
  }

  struct Crossing {
    int layer = 0;
    double share = 1;  ///< of the interval between the nodes
  };

  /// The first surface crossed between node n and the next.
  Crossing crossing(const TrackPiece& piece, int n) const {
    Crossing first;
    for (int layer = 0; layer < piece.layers; ++layer) {
      const TrackNode& a = node(piece, layer, n);
      const TrackNode& b = node(piece, layer, n + 1);
      if ((a.value_m < 0) == (b.value_m < 0)) continue;
      const double share =
          static_cast<double>(a.value_m) / static_cast<double>(a.value_m - b.value_m);
      if (share <= first.share) first = {layer, share};
    }
    return first;
  }

  int nearest_surface(const TrackPiece& piece, int n) const {
    int nearest = 0;
    for (int layer = 1; layer < piece.layers; ++layer) {
      const float candidate = std::abs(node(piece, layer, n).value_m);
      if (candidate < std::abs(node(piece, nearest, n).value_m)) nearest = layer;
    }
    return nearest;
  }

  /// Material at the end of the track so far; -1 before the first.
  phantoms::MaterialIndex current() const {
    return track_.stretches.empty() ? -1 : track_.stretches.back().material;
  }

  void enter(double range_m, phantoms::MaterialIndex material, double cosine) {
    auto& stretches = track_.stretches;
    if (!stretches.empty()) {
      if (stretches.back().material == material) return;
      track_.interfaces.push_back({range_m, stretches.back().material, material, cosine});
      stretches.back().to_m = range_m;
    }
    stretches.push_back({range_m, range_m, material});
  }

  const TissueMap& map_;
  Surfaces surfaces_;
  StickTrack& track_;
  std::vector<Visit> visits_;
  TissueMap::Line line_{};  ///< through the current cell
};

}  // namespace

void follow(const ScannedTissue& tissue,
            const TimedRay& line,
            double depth_m,
            StickTrack& track,
            Surfaces surfaces) {
  track.stretches.clear();
  track.interfaces.clear();
  track.pieces.clear();
  track.layers.clear();
  track.nodes.clear();
  TrackBuilder builder(tissue, surfaces, track);
  const phantoms::Deformation moment = tissue.motion.at(line.time_s);
  double from_m = 0;
  while (from_m < depth_m) {
    const glm::dvec3 rest_m = moment.to_rest(tissue.placement.to_phantom(line.ray.at(from_m)));
    const double to_m =
        std::min(depth_m, from_m + std::max(kNonRigidPiece_m, moment.rigid_radius_m(rest_m)));
    builder.append(straight(tissue, moment, line, from_m, to_m));
    from_m = to_m;
  }
  builder.finish(depth_m);
}

}  // namespace wobblebench::sim
