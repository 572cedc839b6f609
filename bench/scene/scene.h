// A scene: every option of every stage, read from TOML that names only what differs from the
// defaults. Sections map onto option structs one to one.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <set>
#include <string>
#include <vector>

#include "base/options.h"
#include "base/user_error.h"
#include "hw/probe/acquisition_plan.h"
#include "hw/probe/probe.h"
#include "phantoms/options.h"
#include "phantoms/placed_phantom.h"
#include "render/presets.h"
#include "sim/options.h"

namespace wobblebench::bench {

/// Pose of the phantom in the probe frame; the phantom's own suggestion unless given.
struct PlacementOptions {
  glm::dvec3 position_m{0, 0, 0.11};
  glm::dvec3 rotation_rad{0, 0, 0};  ///< about x, then y, then z
};

template <OptionsOf<PlacementOptions> O, class Visitor>
void describe(O& o, Visitor& v) {
  v.vec3("position_mm", o.position_m, kMillimetre, -500, 500);
  v.vec3("rotation_deg", o.rotation_rad, kDegree, -180, 180);
}

/// What the renderer's settings start from, and what is done with z beside its passes.
struct PictureOptions {
  render::RenderPreset preset = render::RenderPreset::accurate;
  /// A renderer of another program, by the name that --renderer gives it: it finds the surface in
  /// place of passes 1 and 2; empty: none.
  std::string program;
  double program_voxel_m = 0.5e-3;  ///< of the Cartesian volume that it gets
  double program_timeout_s = 60;    ///< in which it must answer for one picture
};

template <OptionsOf<PictureOptions> O, class Visitor>
void describe(O& o, Visitor& v) {
  v.choice("preset",
           o.preset,
           {{to_string(render::RenderPreset::accurate), render::RenderPreset::accurate},
            {to_string(render::RenderPreset::baseline), render::RenderPreset::baseline}});
  v.text("program", o.program);
  v.real("program_voxel_mm", o.program_voxel_m, kMillimetre, 0.1, 10);
  v.real("program_timeout_s", o.program_timeout_s, 1, 0.1, 3600);
}

struct Scene {
  phantoms::PhantomOptions phantom;
  PlacementOptions placement;
  phantoms::MotionOptions motion;
  hw::NamedProbeOptions probe;
  hw::AcquisitionOptions acquisition;
  sim::SimulationOptions simulation;
  PictureOptions picture;
  render::RenderOptions render = render::render_preset(picture.preset);
  std::set<std::string> given;  ///< dotted keys that the file or --set named
  /// Those of them that stand in a report, which names every option: nobody's choice.
  std::set<std::string> reported;
  /// Placement and volume of interest, where not given, are those that phantom or sector suggest.
  bool framed = false;

  hw::AcquisitionPlan plan() const { return {probe, acquisition}; }
  /// Somebody gave this key, by a file of TOML or --set.
  bool is_chosen(const std::string& key) const {
    return given.contains(key) && !reported.contains(key);
  }
  /// Whether the options set any motion.
  bool moves() const;
};

/// Calls body(name, options) for each section of a scene.
template <OptionsOf<Scene> S, class Body>
void for_each_section(S& scene, const Body& body) {
  body("phantom", scene.phantom);
  body("placement", scene.placement);
  body("motion", scene.motion);
  body("probe", scene.probe);
  body("acquisition", scene.acquisition);
  body("simulation", scene.simulation);
  body("simulation.clutter", scene.simulation.clutter);
  body("simulation.display", scene.simulation.display);
  body("render", scene.picture);
  body("render.pipeline", scene.render.pipeline);
  body("render.reconstruction", scene.render.reconstruction);
  body("render.scan_conversion", scene.render.scan_conversion);
  body("render.volume_of_interest", scene.render.volume_of_interest);
  body("render.view", scene.render.view);
  body("render.ray_casting", scene.render.ray_casting);
  body("render.shading", scene.render.shading);
  body("render.smoothing", scene.render.smoothing);
}

/// Reads `path` (a scene in TOML, or the report of a command, .json; empty: defaults alone), then
/// applies each "section.key=value" of `settings`, then validates every option. `settings_of`:
/// where the settings are from, for refusals; `preset`: of the renderer, unless they name one.
/// Throws UserError.
Scene load_scene(const std::filesystem::path& path,
                 const std::vector<std::string>& settings,
                 const std::string& settings_of = "--set",
                 render::RenderPreset preset = render::RenderPreset::accurate);

/// load_scene() of a file as it was, with any settings.
using SceneSource = std::function<Scene(const std::vector<std::string>& settings)>;
/// Reads `path`. Throws UserError, first for settings of `first` that are none.
SceneSource scene_source(const std::filesystem::path& path,
                         const std::vector<std::string>& first,
                         const std::string& settings_of = "--set",
                         render::RenderPreset preset = render::RenderPreset::accurate);

/// A scene as report.json of another command holds it, with every option: `resolved`, as
/// resolved() makes it, then each of `settings`. `source`: the report, for refusals. Throws
/// UserError.
Scene load_resolved_scene(const nlohmann::ordered_json& resolved,
                          const std::vector<std::string>& settings,
                          const std::string& source);

/// Throws UserError for a scene with render.program: the command takes no other renderer.
void refuse_program(const Scene& scene, const std::string& command);

/// Every option with its value in the units of its key.
nlohmann::ordered_json resolved(const Scene& scene);
/// The same by keys, "render.view.yaw_deg", as texts of JSON.
std::map<std::string, std::string> values_by_key(const nlohmann::ordered_json& resolved);

/// Runs `body`. A scan too large for its rung, or a phantom whose file holds none, is thrown as
/// UserError that names the scene's section.
template <class Body>
auto with_late_refusals(const Body& body) {
  try {
    return body();
  } catch (const InvalidOption& error) {
    throw UserError(std::string("simulation.") + error.what());
  } catch (const phantoms::InvalidPhantom& error) {
    throw UserError(std::string("phantom.") + error.what());
  }
}

}  // namespace wobblebench::bench
