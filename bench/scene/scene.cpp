#include "bench/scene/scene.h"

#include "base/user_error.h"
#include "phantoms/framing.h"

namespace wobblebench::bench {

phantoms::Placement to_placement(const PlacementOptions& options) {
  return {phantoms::rotation_xyz(options.rotation_rad), options.position_m};
}

bool Scene::moves() const {
  // As if the phantom had a joint: whether it does is not known yet.
  return !phantoms::Motion(motion, phantoms::Joint{}).still();
}

phantoms::PlacedPhantom Scene::place(const phantoms::Phantom& p) const {
  try {
    return {p, to_placement(placement), {motion, p.joint()}};
  } catch (const phantoms::InvalidPhantom& error) {
    throw UserError("motion." + std::string(error.what()));
  }
}

void complete_from_phantom(Scene& scene, const phantoms::Phantom& phantom) {
  const auto framing =
      phantoms::framing(phantom, phantoms::rotation_xyz(scene.placement.rotation_rad));
  if (!scene.given.contains("placement.position_mm")) {
    // The suggestion is for the default face; another radius moves the face along z.
    const double face_moved_m = scene.probe.radius_m - hw::ProbeOptions{}.radius_m;
    scene.placement.position_m = framing.position_m + glm::dvec3(0, 0, face_moved_m);
  }
  const glm::dvec3 low = scene.placement.position_m + framing.region_of_interest.low;
  const glm::dvec3 high = scene.placement.position_m + framing.region_of_interest.high;
  if (!scene.given.contains("render.volume_of_interest.center_mm")) {
    scene.render.volume_of_interest.center_m = 0.5 * (low + high);
  }
  if (!scene.given.contains("render.volume_of_interest.size_mm")) {
    scene.render.volume_of_interest.size_m = high - low;
  }
}

}  // namespace wobblebench::bench
