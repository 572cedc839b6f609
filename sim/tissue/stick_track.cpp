#include "sim/tissue/stick_track.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "sim/tissue/grid_dda.h"

namespace wobblebench::sim {

namespace {

/// Intervals between nodes to one of the map's own. Where a surface passes they are shorter, so
/// that distances run nearly straight in each; farther off, what the beam makes of the surface is
/// smooth.
constexpr double kCrossed = 1.5, kUncrossed = 0.75;
/// Cells that most sticks pass through.
constexpr std::size_t kVisits = 256;
/// Rounding of places within a cell moves distances by less.
constexpr float kOnWall_m = 1e-8f;
/// Straight pieces of a stick where moving tissue bends it.
constexpr double kBentPiece_m = 2e-3;

/// A straight piece of the stick in the rest frame.
struct Straight {
  double from_m;
  double to_m;
  glm::dvec3 origin;     ///< at from_m
  glm::dvec3 direction;  ///< rest metres for a metre of range
  AcrossStick across;

  glm::dvec3 at(double range_m) const { return origin + (range_m - from_m) * direction; }
};

Straight straight(const ScannedTissue& subject,
                  const phantoms::Deformation& moment,
                  const Sightline& line,
                  double from_m,
                  double to_m) {
  const auto rest = [&](const glm::dvec3& place) {
    return moment.to_rest(subject.placement.to_phantom(place));
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

class Follower {
 public:
  Follower(const ScannedTissue& subject, Surfaces surfaces, StickTrack& track)
      : map_(*subject.map), surfaces_(surfaces), track_(track) {
    visits_.reserve(kVisits);
  }

  void walk(const Straight& piece) {
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
  /// A cell, and where the stick is in it.
  struct Visit {
    const TissueMap::Cell* cell = nullptr;
    glm::ivec3 index{0};
    double from_m = 0;
    double to_m = 0;
  };

  /// All cells of a piece before any is looked into, so that what they hold is on its way from
  /// memory together.
  void find_cells(const Straight& piece) {
    visits_.clear();
    for (GridDda walk(map_, piece.origin, piece.direction, piece.from_m, piece.to_m); !walk.done();
         walk.advance()) {
      const double from = walk.from_m(), to = walk.to_m();
      if (to <= from) continue;
      // Member by member: moved as a whole, it would be read before all its parts are written.
      Visit& visit = visits_.emplace_back();
      visit.cell = &map_.cell(walk.cell());
      visit.index = walk.cell();
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

  /// Does no surface pass through the cell? Where the material changes between two cells, its
  /// surface is looked for.
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

  /// Member by member, as what is added here is: moved as a whole, it would be read before all its
  /// parts are written.
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
    if (!is_uncrossed(cell)) mark_interfaces(piece, track_.pieces.back());
  }

  const TissueMap::LineNode& node(const TrackPiece& piece, int layer, int n) const {
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

  void mark_interfaces(const Straight& way, const TrackPiece& piece) {
    const double step = (piece.to_m - piece.from_m) / (piece.nodes - 1);
    const auto cosine = [&](int layer, double range_m) {
      const auto& found = track_.layers[static_cast<std::size_t>(piece.first_layer + layer)];
      const glm::dvec3 normal = map_.normal(found.surface, way.at(range_m));
      return std::min(1.0, std::abs(glm::dot(normal, glm::normalize(way.direction))));
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

  /// Does a surface lie on the wall through which the stick comes? It has been crossed before the
  /// wall, and rounding alone has put the first node before it again.
  bool only_touches(const TrackPiece& piece) const {
    const float value_m = node(piece, nearest_surface(piece, 0), 0).value_m;
    return std::abs(value_m) < kOnWall_m && material(piece, 1) == current();
  }

  /// Does the stick cross none of the piece's surfaces?
  bool keeps_sides(const TrackPiece& piece) const {
    for (int layer = 0; layer < piece.layers; ++layer) {
      const TissueMap::LineNode* nodes = &node(piece, layer, 0);
      const auto inside =
          std::count_if(nodes, nodes + piece.nodes, [](const auto& at) { return at.value_m < 0; });
      if (inside != 0 && inside != piece.nodes) return false;
    }
    return true;
  }

  struct Crossing {
    int layer = 0;
    double share = 1;  ///< of the way from one node to the next
  };

  /// The first surface that is crossed between node n and the next.
  Crossing crossing(const TrackPiece& piece, int n) const {
    Crossing first;
    for (int layer = 0; layer < piece.layers; ++layer) {
      const TissueMap::LineNode& a = node(piece, layer, n);
      const TissueMap::LineNode& b = node(piece, layer, n + 1);
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

  /// What lies where the way has come to; none before it begins.
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
  TissueMap::Line line_{};  ///< through the cell at hand
};

}  // namespace

AcrossStick across_stick(const hw::Ray& ray) {
  // The image plane holds the array, which lies along x.
  const glm::dvec3 elevation = glm::normalize(glm::cross(glm::dvec3(1, 0, 0), ray.direction));
  return {glm::cross(ray.direction, elevation), elevation};
}

void follow(const ScannedTissue& subject,
            const Sightline& line,
            double depth_m,
            StickTrack& track,
            Surfaces surfaces) {
  track.stretches.clear();
  track.interfaces.clear();
  track.pieces.clear();
  track.layers.clear();
  track.nodes.clear();
  Follower follower(subject, surfaces, track);
  const phantoms::Deformation moment = subject.motion.at(line.time_s);
  double from_m = 0;
  while (from_m < depth_m) {
    const glm::dvec3 rest_m = moment.to_rest(subject.placement.to_phantom(line.ray.at(from_m)));
    const double to_m = std::min(depth_m, from_m + std::max(kBentPiece_m, moment.rigid_radius_m(rest_m)));
    follower.walk(straight(subject, moment, line, from_m, to_m));
    from_m = to_m;
  }
  follower.finish(depth_m);
}

}  // namespace wobblebench::sim
