#include "bench/scene/scene.h"

#include "base/user_error.h"
#include "phantoms/framing.h"

namespace wobblebench::bench {

namespace {

/// Around the samples: their extremes lie at the edges and in the middle of sector, fan and range.
phantoms::Box scanned_box(const hw::AcquisitionPlan& plan) {
  const hw::ProbeGeometry geometry = plan.geometry();
  const hw::AcquisitionOptions& scan = plan.acquisition();
  phantoms::Box bounds{glm::dvec3(std::numeric_limits<double>::infinity()),
                       glm::dvec3(-std::numeric_limits<double>::infinity())};
  for (const double range_m : {0.0, scan.depth_m}) {
    for (const double theta_rad : {-0.5 * scan.sector_rad, 0.0, 0.5 * scan.sector_rad}) {
      for (const double phi_rad : {-0.5 * scan.fan_rad, 0.0, 0.5 * scan.fan_rad}) {
        const glm::dvec3 point = geometry.to_cartesian({range_m, theta_rad, phi_rad});
        bounds = {glm::min(bounds.low, point), glm::max(bounds.high, point)};
      }
    }
  }
  return bounds;
}

void set_volume_of_interest(Scene& scene, const phantoms::Box& box) {
  if (!scene.given.contains("render.volume_of_interest.center_mm")) {
    scene.render.volume_of_interest.center_m = 0.5 * (box.low + box.high);
  }
  if (!scene.given.contains("render.volume_of_interest.size_mm")) {
    scene.render.volume_of_interest.size_m = box.high - box.low;
  }
}

}  // namespace

phantoms::Placement to_placement(const PlacementOptions& options) {
  return {phantoms::rotation_xyz(options.rotation_rad), options.position_m};
}

bool Scene::moves() const {
  // As if the phantom had a joint and a mouth of any size: whether it does is not known yet.
  phantoms::Joint joint;
  joint.mouth = phantoms::Mouth{.opening_m = 1, .reach_m = 1};
  return !phantoms::Motion(motion, joint).still();
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
  set_volume_of_interest(scene,
                         {scene.placement.position_m + framing.region_of_interest.low,
                          scene.placement.position_m + framing.region_of_interest.high});
}

void complete_from_plan(Scene& scene) {
  phantoms::Box box = scanned_box(scene.plan());
  // What the option allows: a sector or fan of 0.1 degrees is narrower than a millimetre, and of
  // the widest probe, 0.6 m, the outermost 10 cm are left out.
  const glm::dvec3 middle = 0.5 * (box.low + box.high);
  const glm::dvec3 half = glm::clamp(0.5 * (box.high - box.low), 0.5e-3, 0.5);
  set_volume_of_interest(scene, {middle - half, middle + half});
}

}  // namespace wobblebench::bench
