// Tissue along a stick: the materials on its axis, the interfaces between them, and sampled
// distances to the surfaces near the axis.
#pragma once

#include <cstdint>
#include <vector>

#include "phantoms/material.h"
#include "sim/tissue/scanned_tissue.h"

namespace wobblebench::sim {

struct ScannedTissue;

/// A change of material on the axis.
struct Interface {
  double range_m = 0;
  phantoms::MaterialIndex before = 0;
  phantoms::MaterialIndex behind = 0;
  double cos_incidence = 1;  ///< between the stick and the surface's normal, 0 to 1
};

/// A section of the axis within one material.
struct Stretch {
  double from_m = 0;
  double to_m = 0;
  phantoms::MaterialIndex material = 0;
};

/// The section of the axis within one cell of the tissue map, or within consecutive cells of one
/// material. Its layers are the surfaces near it in painter's order, each sampled at `nodes`
/// equidistant nodes from `from_m` to `to_m`.
struct TrackPiece {
  double from_m = 0;
  double to_m = 0;
  phantoms::MaterialIndex base = 0;  ///< material outside all its layers
  int first_layer = 0;
  int layers = 0;  ///< 0: the whole piece is of the material `base`
  int nodes = 0;
};

struct TrackLayer {
  std::int32_t surface = 0;
  phantoms::MaterialIndex inside = 0;
  int first_node = 0;
};

/// Signed distance to a surface, and its derivatives along the stick, across it in the image plane,
/// and across the image plane.
struct TrackNode {
  float value_m = 0;  ///< negative inside
  float axial = 0;
  float lateral = 0;
  float elevation = 0;
};

/// Ranges are true lengths along the stick from the face. Stretches and pieces each cover the stick
/// without gaps, nearest first.
struct StickTrack {
  std::vector<Stretch> stretches;
  std::vector<Interface> interfaces;  ///< one between each two stretches
  std::vector<TrackPiece> pieces;
  std::vector<TrackLayer> layers;
  std::vector<TrackNode> nodes;
};

/// Which surfaces a track has layers of.
enum class Surfaces {
  nearby,   ///< all within the map's reach of the stick
  crossed,  ///< only those of the cells in which the stick crosses one; same interfaces
};

/// Traces a stick through the tissue from the face to `depth_m`. Overwrites `track`, reusing its
/// memory.
void follow(const ScannedTissue& tissue,
            const TimedRay& line,
            double depth_m,
            StickTrack& track,
            Surfaces surfaces = Surfaces::nearby);

}  // namespace wobblebench::sim
