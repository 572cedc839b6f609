// What is scanned: tissue at rest, where it stands, and how it moves.
#pragma once

#include <memory>
#include <vector>

#include "hw/probe/acquisition_plan.h"
#include "phantoms/motion.h"
#include "phantoms/phantom.h"
#include "sim/tissue/tissue_map.h"

namespace wobblebench::sim {

struct ScannedTissue {
  std::shared_ptr<const TissueMap> map;  ///< tissue at rest, phantom frame
  std::vector<phantoms::Material> materials;
  phantoms::Placement placement;
  phantoms::Motion motion;

  /// Probe frame at a time to the rest frame, and back.
  glm::dvec3 to_rest(const glm::dvec3& probe_m, double time_s) const {
    return motion.to_rest(placement.to_phantom(probe_m), time_s);
  }
  glm::dvec3 from_rest(const glm::dvec3& rest_m, double time_s) const {
    return placement.to_probe(motion.from_rest(rest_m, time_s));
  }
};

/// When and where one stick looks.
struct Sightline {
  hw::Ray ray;        ///< probe frame, from the face
  double time_s = 0;  ///< device time of the stick: tissue is where it is then
};

}  // namespace wobblebench::sim
