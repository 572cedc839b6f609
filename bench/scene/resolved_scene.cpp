#include "bench/scene/resolved_scene.h"

#include <limits>
#include <nlohmann/json.hpp>
#include <utility>

#include "base/user_error.h"
#include "bench/scene/given_aperture.h"
#include "bench/scene/scene_cost.h"
#include "hw/probe/beam_width.h"
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

/// Sets placement and volume of interest as the phantom suggests, where they were not given.
void frame_phantom(Scene& scene, const phantoms::Phantom& phantom) {
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

/// Sets the volume of interest to the box around the scanned sector, where it was not given.
void frame_sector(Scene& scene) {
  phantoms::Box box = scanned_box(scene.plan());
  // What the option allows: a sector or fan of 0.1 degrees is narrower than a millimetre, and of
  // the widest probe, 0.6 m, the outermost 10 cm are left out.
  const glm::dvec3 middle = 0.5 * (box.low + box.high);
  const glm::dvec3 half = glm::clamp(0.5 * (box.high - box.low), 0.5e-3, 0.5);
  set_volume_of_interest(scene, {middle - half, middle + half});
}

phantoms::PlacedPhantom placed(const Scene& scene, const phantoms::Phantom& phantom) {
  const auto& [position_m, rotation_rad] = scene.placement;
  try {
    return {phantom,
            {phantoms::rotation_xyz(rotation_rad), position_m},
            {scene.motion, phantom.joint()}};
  } catch (const phantoms::InvalidPhantom& error) {
    throw UserError("motion." + std::string(error.what()));
  }
}

/// The value of a dotted key whose section has no dot; null for any other.
nlohmann::ordered_json value_of(const nlohmann::ordered_json& scene, const std::string& key) {
  const auto dot = key.find('.');
  const auto section = scene.find(key.substr(0, dot));
  if (section == scene.end()) return nullptr;
  const auto value = section->find(key.substr(dot + 1));
  return value == section->end() ? nlohmann::ordered_json(nullptr) : *value;
}

/// A stream's acquisition, whose zones but one are dead time: with the scene's zones where it is
/// the same schedule.
hw::AcquisitionOptions with_zones_of(const hw::AcquisitionOptions& scene,
                                     const hw::AcquisitionOptions& delivered) {
  hw::AcquisitionOptions zoned = delivered;
  zoned.focal_zones = scene.focal_zones;
  zoned.dead_time_s = scene.dead_time_s;
  return hw::with_one_zone(zoned) == delivered ? zoned : delivered;
}

/// The probe that delivers, with the scene's aperture where it does not know its own.
hw::ProbeOptions adopted_probe(const Scene& scene, const hw::ProbeOptions& delivered) {
  if (hw::knows_array(delivered) && hw::knows_lens(delivered)) return delivered;
  const auto has = [&](const std::string& key) { return scene.given.contains("probe." + key); };
  const auto refuse = [](const std::string& why) { throw UserError("probe." + why); };
  const hw::ProbeOptions probe =
      hw::with_aperture_of(delivered, with_given_aperture(scene.probe, has, refuse));
  const bool has_beam = hw::knows_array(probe) || hw::knows_lens(probe);
  for (const std::string key : {"center_frequency_mhz", "fractional_bandwidth"}) {
    if (!has_beam && has(key)) refuse(key + ": acts with probe.elements or .element_height_mm");
  }
  return probe;
}

/// Why the preset that the user named is not the probe that delivers; empty: it is. `before`,
/// `after`: the scene's probe, and the one that delivers.
std::string preset_conflict(const Scene& scene,
                            const hw::ProbeOptions& delivered,
                            const nlohmann::ordered_json& before,
                            const nlohmann::ordered_json& after,
                            const std::string& source) {
  if (!scene.given.contains("probe.preset")) return "";
  // Where the aperture is not known only the face is: that they wobble is no presets' own.
  if (!hw::knows_array(delivered) || !hw::knows_lens(delivered)) {
    return preset_refusal(scene.probe.preset, delivered.radius_m);
  }
  for (const auto& [key, wanted] : before.items()) {
    if (wanted == after.at(key)) continue;
    return "its " + key + " is " + wanted.dump() + "; " + source + " delivers " +
           after.at(key).dump();
  }
  return "";
}

bool belongs_to_plan(const std::string& key) {
  return key.starts_with("acquisition.") || key.starts_with("probe.");
}

/// Rules that depend on the volume of interest, which the file may have left open.
void check_render(const render::RenderOptions& options) {
  try {
    render::validate(options);
  } catch (const InvalidOption& error) {
    throw UserError("render." + std::string(error.what()));
  }
}

}  // namespace

ResolvedScene::ResolvedScene(Scene options, std::optional<phantoms::PlacedPhantom> subject)
    : options_(std::move(options)),
      plan_(options_.plan()),
      view_(render::make_view(options_.render)),
      subject_(std::move(subject)) {}

ResolvedScene resolve_scene(Scene scene, const std::optional<phantoms::Phantom>& phantom) {
  if (!scene.given.contains("render.reconstruction.display_range_db")) {
    scene.render.reconstruction.display_range_db = scene.simulation.dynamic_range_db;
  }
  scene.framed = true;
  if (!phantom) {
    frame_sector(scene);
    check_render(scene.render);
    return {std::move(scene), std::nullopt};
  }
  frame_phantom(scene, *phantom);
  check_render(scene.render);
  auto subject = placed(scene, *phantom);
  return {std::move(scene), std::move(subject)};
}

Scene with_plan(const Scene& scene, const hw::AcquisitionPlan& plan, const std::string& source) {
  Scene adopted = scene;
  static_cast<hw::ProbeOptions&>(adopted.probe) = adopted_probe(scene, plan.probe());
  adopted.acquisition = with_zones_of(scene.acquisition, plan.acquisition());
  const auto before = resolved(scene), after = resolved(adopted);
  for (const std::string& key : scene.given) {
    if (!belongs_to_plan(key)) continue;
    const auto wanted = value_of(before, key);
    const auto delivered = value_of(after, key);
    if (wanted == delivered) continue;
    throw UserError(key + " = " + wanted.dump() + ": " + source + " delivers " + delivered.dump());
  }
  const std::string conflict =
      preset_conflict(scene, plan.probe(), before.at("probe"), after.at("probe"), source);
  if (!conflict.empty()) {
    throw UserError("probe.preset = " + before.at("probe").at("preset").get<std::string>() + ": " +
                    conflict);
  }
  check_memory(adopted, source, available_memory_bytes());
  return adopted;
}

Scene with_display_scale(Scene scene, const hw::DisplayScale& scale) {
  if (!scale.knows_range()) return scene;
  if (scale.stated()) {
    scene.simulation.full_scale_db = scale.full_scale_db;
    scene.simulation.tgc_db_per_cm_mhz = scale.tgc_db_per_cm_mhz;
  }
  if (!scene.given.contains("simulation.dynamic_range_db")) {
    scene.simulation.dynamic_range_db = scale.dynamic_range_db;
  }
  return scene;
}

}  // namespace wobblebench::bench
