// A stick's way through the tissue: what lies on its axis, and which surfaces pass close by.
#pragma once

#include <vector>

#include "sim/tissue/scanned_tissue.h"

namespace wobblebench::sim {

/// Where the material changes on the axis.
struct Interface {
  double range_m = 0;
  phantoms::MaterialIndex before = 0;
  phantoms::MaterialIndex behind = 0;
  double cos_incidence = 1;  ///< against the surface's normal, 0 to 1
};

/// A stretch of the axis within one material.
struct Stretch {
  double from_m = 0;
  double to_m = 0;
  phantoms::MaterialIndex material = 0;
};

/// One cell's share of the axis, with the surfaces nearby in painter's order. Each has `nodes`
/// nodes, spread evenly from `from_m` to `to_m`.
struct TrackPiece {
  double from_m = 0;
  double to_m = 0;
  phantoms::MaterialIndex base = 0;  ///< what lies there but for the surfaces
  int first_layer = 0;
  int layers = 0;  ///< none: all of it is `base`
  int nodes = 0;
};

struct TrackLayer {
  std::int32_t surface = 0;
  phantoms::MaterialIndex inside = 0;
  int first_node = 0;
};

/// All ranges are true lengths along the stick from the face. Stretches and pieces cover it without
/// gaps, nearest first.
struct StickTrack {
  std::vector<Stretch> stretches;
  std::vector<Interface> interfaces;  ///< one between each two stretches
  std::vector<TrackPiece> pieces;
  std::vector<TrackLayer> layers;
  /// Distance to the surface (negative inside), and how it grows along the stick, across it in the
  /// image plane, and across the image plane.
  std::vector<TissueMap::LineNode> nodes;
};

/// The surfaces that a track tells of.
enum class Surfaces {
  nearby,   ///< all within the map's reach of the stick
  crossed,  ///< those of the cells through which one passes; interfaces are the same
};

/// Follows a stick from the face to `depth_m`. Reuses what `track` holds.
void follow(const ScannedTissue& subject,
            const Sightline& line,
            double depth_m,
            StickTrack& track,
            Surfaces surfaces = Surfaces::nearby);

/// Directions across a stick: in the image plane towards greater theta, and across it towards
/// greater phi.
struct AcrossStick {
  glm::dvec3 lateral;
  glm::dvec3 elevation;
};
AcrossStick across_stick(const hw::Ray& ray);

}  // namespace wobblebench::sim
