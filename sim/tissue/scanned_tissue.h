// The scanned tissue: its map at rest, its materials, its placement before the probe, its motion.
#pragma once

#include <memory>
#include <vector>

#include "phantoms/motion.h"
#include "phantoms/phantom.h"
#include "sim/tissue/timed_ray.h"
#include "sim/tissue/tissue_map.h"

namespace wobblebench::sim {

struct ScannedTissue {
  std::shared_ptr<const TissueMap> map;  ///< tissue at rest, phantom frame
  std::vector<phantoms::Material> materials;
  phantoms::Placement placement;
  phantoms::Motion motion;
  /// Beside the tissue, in the phantom frame at rest; null: none.
  std::shared_ptr<const phantoms::PointScatterers> points = nullptr;

  bool has_points() const { return points && !points->empty(); }
  /// Nothing moves, tissue or points.
  bool still() const { return motion.still() && (!points || points->all_fixed()); }

  /// From the probe frame at a time to the phantom frame at rest, and back.
  glm::dvec3 to_rest(const glm::dvec3& probe_m, double time_s) const {
    return motion.to_rest(placement.to_phantom(probe_m), time_s);
  }
  glm::dvec3 from_rest(const glm::dvec3& rest_m, double time_s) const {
    return placement.to_probe(motion.from_rest(rest_m, time_s));
  }
};

}  // namespace wobblebench::sim
