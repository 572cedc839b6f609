#include "bench/scene/idle_options.h"

#include <algorithm>
#include <initializer_list>
#include <string_view>

#include "sim/fidelity.h"
#include "sim/rungs/echo_model.h"

namespace wobblebench::bench {

namespace {

using render::Detector, render::RenderMode;

/// A scene, and the rung that it is simulated on.
struct Setting {
  const Scene& scene;
  const sim::EchoModelType& model;

  bool is(std::initializer_list<std::string_view> phantoms) const {
    return std::find(phantoms.begin(), phantoms.end(), scene.phantom.name) != phantoms.end();
  }
  bool seeks_surface() const { return scene.render.ray_casting.mode != RenderMode::volume; }
  bool blends() const { return scene.render.ray_casting.mode != RenderMode::surface; }
  bool detects_by(Detector detector) const {
    return seeks_surface() && scene.render.ray_casting.detector == detector;
  }
  /// Whether the rung was chosen by what the options switch on.
  bool rung_is_free() const { return scene.simulation.fidelity == sim::Rung::automatic; }
  bool models_beam() const { return model.models("beam_width"); }
};

/// Keys that act under one condition.
struct Rule {
  std::vector<std::string_view> keys;
  std::string_view acts_with;
  bool (*acts)(const Setting&);
};

const std::vector<Rule>& rules_of_phantoms() {
  static const std::vector<Rule> rules = {
      {{"phantom.file"},
       "phantom.name = mesh, vdb or file",
       [](const Setting& s) {
         return s.is({"mesh", "vdb", "file"});
       }},
      {{"phantom.voxel_mm"},
       "phantoms made here or read from a mesh, but points",
       [](const Setting& s) {
         return !s.is({"vdb", "file", "points"});
       }},
      {{"phantom.gestational_age_weeks",
        "phantom.identity",
        "phantom.maternal_layer_mm",
        "phantom.mouth_open_mm",
        "phantom.head_pitch_deg",
        "phantom.head_yaw_deg",
        "phantom.head_roll_deg",
        "phantom.smile_mm",
        "phantom.tongue_mm",
        "phantom.lids_open_mm",
        "phantom.cleft_width_mm",
        "phantom.chin_back_deg",
        "phantom.jaw_shorter_mm",
        "phantom.nasal_bone_shorter_mm",
        "phantom.eyes_apart_mm",
        "phantom.bossing_mm",
        "phantom.ears_lower_deg",
        "phantom.hand",
        "phantom.cord",
        "phantom.placenta_mm"},
       "phantom.name = fetal_face",
       [](const Setting& s) { return s.is({"fetal_face"}); }},
      {{"phantom.cleft_side", "phantom.cleft_alveolus_mm"},
       "phantom.name = fetal_face and phantom.cleft_width_mm",
       [](const Setting& s) { return s.is({"fetal_face"}) && s.scene.phantom.cleft_width_m > 0; }},
      {{"phantom.hand_gap_mm"},
       "phantom.name = fetal_face and phantom.hand = before",
       [](const Setting& s) {
         return s.is({"fetal_face"}) && s.scene.phantom.hand == phantoms::HandPlace::before;
       }},
      {{"phantom.cord_gap_mm"},
       "phantom.name = fetal_face and phantom.cord = before",
       [](const Setting& s) {
         return s.is({"fetal_face"}) && s.scene.phantom.cord == phantoms::CordPlace::before;
       }},
      {{"phantom.radius_mm"},
       "phantom.name = sphere or cyst",
       [](const Setting& s) {
         return s.is({"sphere", "cyst"});
       }},
      {{"phantom.step_heights_mm"},
       "phantom.name = steps",
       [](const Setting& s) { return s.is({"steps"}); }},
      {{"phantom.thickness_mm"},
       "phantom.name = bone_plate",
       [](const Setting& s) { return s.is({"bone_plate"}); }},
      {{"phantom.point_echo_db"},
       "phantom.name = points",
       [](const Setting& s) { return s.is({"points"}); }},
      {{"phantom.tilt_x_deg", "phantom.tilt_y_deg"},
       "phantom.name = plane or bone_plate",
       [](const Setting& s) {
         return s.is({"plane", "bone_plate"});
       }},
      {{"phantom.unit_mm", "phantom.materials", "phantom.target"},
       "phantom.name = mesh or vdb",
       [](const Setting& s) {
         return s.is({"mesh", "vdb"});
       }},
      {{"phantom.grids"}, "phantom.name = vdb", [](const Setting& s) { return s.is({"vdb"}); }},
      {{"phantom.targets"},
       "phantom.name = vdb and phantom.target",
       [](const Setting& s) { return s.is({"vdb"}) && s.scene.phantom.target; }},
      {{"phantom.background"},
       "phantom.name = mesh, vdb or points",
       [](const Setting& s) {
         return s.is({"mesh", "vdb", "points"});
       }},
      {{"phantom.scatterers_gain_db"},
       "phantom.scatterers",
       [](const Setting& s) { return !s.scene.phantom.scatterers.empty(); }},
      {{"motion.breath_period_s"},
       "motion.breath_amplitude_mm",
       [](const Setting& s) { return s.scene.motion.breath_amplitude_m != 0; }},
      {{"motion.heartbeat_period_s"},
       "motion.heartbeat_amplitude_mm",
       [](const Setting& s) { return s.scene.motion.heartbeat_amplitude_m != 0; }},
      {{"motion.head_turn_period_s", "motion.head_axis"},
       "motion.head_turn_deg",
       [](const Setting& s) { return s.scene.motion.head_turn_rad != 0; }},
      {{"motion.mouth_period_s"}, "motion.mouth_close_mm", [](const Setting& s) {
         return s.scene.motion.mouth_close_m != 0;
       }}};
  return rules;
}

const std::vector<Rule>& rules_of_simulation() {
  static const std::vector<Rule> rules = {
      {{"acquisition.fly_back_ms"},
       "acquisition.motor = fly_back",
       [](const Setting& s) { return s.scene.acquisition.motor == hw::MotorMode::fly_back; }},
      {{"probe.center_frequency_mhz",
        "probe.fractional_bandwidth",
        "probe.f_number",
        "probe.transmit_focus_mm",
        "probe.elements",
        "probe.pitch_mm",
        "probe.element_height_mm",
        "probe.elevation_focus_mm",
        "simulation.apodisation",
        "simulation.low_pass",
        "simulation.tgc_db_per_cm_mhz"},
       "simulation.fidelity = field or higher",
       [](const Setting& s) { return s.models_beam(); }},
      {{"simulation.speckle",
        "simulation.attenuation",
        "simulation.transmission_loss",
        "simulation.interface_echo",
        "simulation.noise_db",
        "simulation.tissue_sound_speed"},
       "simulation.fidelity = field or higher",
       [](const Setting& s) { return s.rung_is_free() || s.models_beam(); }},
      {{"simulation.side_lobes"},
       "simulation.fidelity = scatterers or reference",
       [](const Setting& s) { return s.rung_is_free() || s.model.models("side_lobes"); }},
      {{"simulation.aperture_losses"},
       "simulation.attenuation or simulation.transmission_loss, on the rung field or higher",
       [](const Setting& s) {
         const auto& o = s.scene.simulation;
         return s.models_beam() && (o.attenuation || o.transmission_loss);
       }},
      {{"simulation.specular_width_deg"},
       "simulation.interface_echo, on the rung field or higher",
       [](const Setting& s) { return s.models_beam() && s.scene.simulation.interface_echo; }},
      {{"simulation.clutter.probe_reflection",
        "simulation.clutter.haze_db",
        "simulation.clutter.particles_per_cm3",
        "simulation.clutter.tissue_unevenness_db"},
       "simulation.fidelity = field or higher",
       [](const Setting& s) { return s.rung_is_free() || s.models_beam(); }},
      {{"simulation.clutter.haze_reach_deg",
        "simulation.clutter.haze_trail_mm",
        "simulation.clutter.haze_fall_db_per_cm",
        "simulation.clutter.haze_unevenness_db"},
       "simulation.clutter.haze_db above -200, on the rung field or higher",
       [](const Setting& s) { return s.models_beam() && s.scene.simulation.clutter.has_haze(); }},
      {{"simulation.clutter.particle_echo_db"},
       "simulation.clutter.particles_per_cm3 above 0, on the rung field or higher",
       [](const Setting& s) {
         return s.models_beam() && s.scene.simulation.clutter.particles_per_cm3 > 0;
       }},
      {{"simulation.clutter.tissue_grain_mm", "simulation.clutter.even_skin_mm"},
       "simulation.clutter.tissue_unevenness_db above 0, on the rung field or higher",
       [](const Setting& s) {
         return s.models_beam() && s.scene.simulation.clutter.tissue_unevenness_db > 0;
       }},
      {{"simulation.display.grey_bits"},
       "simulation.output = log",
       [](const Setting& s) {
         return s.scene.simulation.output == hw::SampleScale::log_compressed;
       }},
      {{"simulation.scatterers_per_cell"},
       "simulation.fidelity = scatterers or reference",
       [](const Setting& s) { return s.model.models("scatterers_in_tissue"); }},
      {{"simulation.seed"},
       "simulation.speckle, simulation.noise_db or simulation.clutter, on the rung field or higher",
       [](const Setting& s) {
         const auto& o = s.scene.simulation;
         return s.models_beam() &&
                (o.speckle || o.noise_db > sim::kZeroAmplitude_db || o.clutter.random());
       }}};
  return rules;
}

const std::vector<Rule>& rules_of_rays() {
  static const std::vector<Rule> rules = {
      {{"render.reconstruction.spacing_mm", "render.reconstruction.steepest_deg"},
       "render.reconstruction.sticks = aligned",
       [](const Setting& s) {
         return s.scene.render.reconstruction.sticks == render::Sticks::aligned;
       }},
      {{"render.reconstruction.edge_level"},
       "render.reconstruction.sticks = aligned or render.ray_casting.iso_level = auto",
       [](const Setting& s) {
         return s.scene.render.reconstruction.sticks == render::Sticks::aligned ||
                render::has_stick_levels(s.scene.render);
       }},
      {{"render.reconstruction.display_range_db", "render.ray_casting.below_tissue_db"},
       "render.ray_casting.iso_level = auto, where a surface is sought",
       [](const Setting& s) { return render::has_stick_levels(s.scene.render); }},
      {{"render.view.eye_distance_mm"},
       "render.view.projection = perspective",
       [](const Setting& s) {
         return s.scene.render.view.projection == render::Projection::perspective;
       }},
      {{"render.ray_casting.detector",
        "render.ray_casting.incidence_correction_mm",
        "render.ray_casting.outline_mm",
        "render.ray_casting.refine_crossing",
        "render.ray_casting.smallest_piece_mm2",
        "render.ray_casting.window_2d"},
       "render.ray_casting.mode = surface or both",
       [](const Setting& s) { return s.seeks_surface(); }},
      {{"render.ray_casting.threshold",
        "render.ray_casting.threshold_per_sample",
        "render.ray_casting.buffer_length",
        "render.ray_casting.buffer_length_mm"},
       "render.ray_casting.detector = paper, where a surface is sought",
       [](const Setting& s) { return s.detects_by(Detector::paper); }},
      {{"render.ray_casting.threshold"},
       "render.ray_casting.threshold_per_sample = 0",
       [](const Setting& s) { return s.scene.render.ray_casting.threshold_per_sample == 0; }},
      {{"render.ray_casting.caps"},
       "render.ray_casting.detector = iso, where a surface is sought",
       [](const Setting& s) { return s.detects_by(Detector::iso); }},
      {{"render.ray_casting.iso_level"},
       "render.ray_casting.detector = iso or floor, where a surface is sought",
       [](const Setting& s) {
         return s.detects_by(Detector::iso) || s.detects_by(Detector::floor);
       }},
      {{"render.ray_casting.kernel_space"},
       "render.ray_casting.kernel_3d above 1",
       [](const Setting& s) { return s.scene.render.ray_casting.kernel_3d > 1; }},
      {{"render.ray_casting.opacity_limit",
        "render.ray_casting.transfer_values",
        "render.ray_casting.transfer_opacity_per_mm",
        "render.ray_casting.transfer_grey"},
       "render.ray_casting.mode = volume or both",
       [](const Setting& s) { return s.blends(); }}};
  return rules;
}

const std::vector<Rule>& rules_of_shading() {
  static const std::vector<Rule> rules = {
      {{"render.shading.light_distance_mm"},
       "render.shading.light = point",
       [](const Setting& s) { return s.scene.render.shading.light == render::Light::point; }},
      {{"render.shading.shininess"},
       "render.shading.specular above 0",
       [](const Setting& s) { return s.scene.render.shading.specular > 0; }},
      {{"render.shading.shadow_coefficient", "render.shading.shadow_bias_mm"},
       "render.shading.shadows",
       [](const Setting& s) { return s.scene.render.shading.shadows; }},
      {{"render.smoothing.filter"},
       "render.smoothing.filter_size above 1",
       [](const Setting& s) { return s.scene.render.smoothing.filter_size > 1; }},
      {{"render.smoothing.range_sigma"},
       "render.smoothing.filter = bilateral or guided, and a filter_size above 1",
       [](const Setting& s) {
         const auto& o = s.scene.render.smoothing;
         return o.filter != render::SmoothingFilter::box && o.filter_size > 1;
       }}};
  return rules;
}

/// Linear envelopes are displayed over a dynamic range of the scene, wherever they come from.
bool acts_on_received_samples(const std::string& key) {
  return key == "simulation.dynamic_range_db";
}

/// Why a key is without effect on samples that are not simulated here; empty: that is no reason.
std::string idle_by_source(const std::string& key, SampleSource source) {
  const auto is_of = [&](const char* section) { return key.starts_with(section); };
  if (source == SampleSource::simulator) return "";
  if (is_of("simulation.") && !acts_on_received_samples(key)) return "--board sim";
  const bool of_subject = is_of("phantom.") || is_of("placement.") || is_of("motion.");
  if (source == SampleSource::unknown_subject && of_subject)
    return "a scene whose samples they are";
  return "";
}

/// Keys of passes 1 and 2, which a renderer of another program replaces: all but the view's.
bool is_of_own_renderer(const std::string& key) {
  return key.starts_with("render.pipeline.") || key.starts_with("render.reconstruction.") ||
         key.starts_with("render.scan_conversion.") ||
         (key.starts_with("render.ray_casting.") && key != "render.ray_casting.image_size" &&
          key != "render.ray_casting.edge");
}

std::string idle_by_rules(const std::string& key, const Setting& setting) {
  const bool other_program = !setting.scene.picture.program.empty();
  if (other_program && is_of_own_renderer(key)) return "render.program empty";
  const bool of_program = key == "render.program_voxel_mm" || key == "render.program_timeout_s";
  if (of_program && !other_program) return "render.program";
  const bool of_surface =
      key.starts_with("render.shading.") || key.starts_with("render.smoothing.");
  if (of_surface && !setting.seeks_surface()) return "render.ray_casting.mode = surface or both";
  for (const auto* rules :
       {&rules_of_phantoms(), &rules_of_simulation(), &rules_of_rays(), &rules_of_shading()}) {
    for (const Rule& rule : *rules) {
      const bool named = std::find(rule.keys.begin(), rule.keys.end(), key) != rule.keys.end();
      if (named && !rule.acts(setting)) return std::string(rule.acts_with);
    }
  }
  return "";
}

}  // namespace

std::vector<IdleOption> idle_options(const Scene& scene,
                                     const std::set<std::string>& given,
                                     SampleSource source) {
  // A phantom's file may hold points.
  const bool points = scene.phantom.name == "points" || scene.phantom.name == "file" ||
                      !scene.phantom.scatterers.empty();
  const auto fidelity = sim::choose_fidelity(scene.simulation, scene.plan(), scene.moves(), points);
  const Setting setting{scene, sim::echo_model_type(fidelity.rung)};
  std::vector<IdleOption> idle;
  for (const std::string& key : given) {
    if (scene.reported.contains(key)) continue;
    std::string acts_with = idle_by_source(key, source);
    if (acts_with.empty()) acts_with = idle_by_rules(key, setting);
    if (!acts_with.empty()) idle.push_back({key, acts_with});
  }
  return idle;
}

std::vector<std::string> idle_keys_of_subject(const Scene& scene) {
  // No rule of a phantom or a motion asks for the rung.
  const Setting setting{scene, sim::echo_model_type(sim::Rung::geometry)};
  std::vector<std::string> keys;
  for (const Rule& rule : rules_of_phantoms()) {
    if (!rule.acts(setting)) keys.insert(keys.end(), rule.keys.begin(), rule.keys.end());
  }
  return keys;
}

std::string idle_options_text(const std::vector<IdleOption>& options) {
  std::string text;
  for (const auto& [key, acts_with] : options) {
    text += (text.empty() ? "without effect in this scene: " : ", ") + key + " (acts with " +
            acts_with + ")";
  }
  return text;
}

void IdleInAll::add(const Scene& scene, const std::set<std::string>& given) {
  const auto idle = idle_options(scene, given);
  const auto has = [](const std::vector<IdleOption>& list, const std::string& key) {
    return std::any_of(list.begin(), list.end(), [&](const auto& one) { return one.key == key; });
  };
  for (const std::string& key : given) {
    if (!has(idle, key)) acting_.insert(key);
  }
  for (const IdleOption& option : idle) {
    if (!has(idle_, option.key)) idle_.push_back(option);
  }
}

std::vector<IdleOption> IdleInAll::options() const {
  std::vector<IdleOption> all;
  std::copy_if(idle_.begin(), idle_.end(), std::back_inserter(all), [&](const IdleOption& option) {
    return !acting_.contains(option.key);
  });
  return all;
}

}  // namespace wobblebench::bench
