#include "bench/pipeline/scene_warnings.h"

#include <algorithm>
#include <set>
#include <utility>

#include "base/number_text.h"
#include "hw/probe/beam_width.h"

namespace wobblebench::bench {

namespace {

std::string degrees(double rad) {
  return significant(rad / kDegree, 3);
}

/// That of the preset, with which the correction was measured.
bool is_known_receiver(const sim::SimulationOptions& o) {
  const sim::SimulationOptions standard = sim::simulation_preset(o.preset);
  return o.full_scale_db == standard.full_scale_db &&
         o.dynamic_range_db == standard.dynamic_range_db &&
         o.tgc_db_per_cm_mhz == standard.tgc_db_per_cm_mhz;
}

/// Empty: array and lens are known.
std::string unknown_aperture(const hw::ProbeOptions& probe) {
  const bool has_array = hw::knows_array(probe), has_lens = hw::knows_lens(probe);
  if (has_array && has_lens) return "";
  return has_array  ? "the lens of the probe is not known"
         : has_lens ? "the array of the probe is not known"
                    : "the aperture of the probe is not known";
}

/// What the surface is then. The lengths are those of simulated faces that were read back without
/// the aperture of the probes default and curvilinear-60 (exchange_aperture).
std::string uncorrected_text(const std::string& unknown) {
  return unknown +
         ", so that nothing is corrected for the width of its beam: the surface is an iso-surface "
         "before the skin, on a face by half of the beam's width there (median: 1.2 mm for a beam "
         "2.4 mm wide, 2.3 mm for one of 4.3 mm; 1.4 times that in a scan with a scanner's clutter "
         "and smoothing), and further where the skin is tilted to the "
         "beam; "
         "a geometry file or probe.* can give the aperture (docs/exchange.md)";
}

/// What the automatic correction cannot know; empty: nothing.
std::string unknown_to_correction(const Scene& scene, SampleSource source) {
  if (source == SampleSource::unknown_subject) {
    return "of the aperture that the scene's probe.* give, and the samples are not simulated";
  }
  if (is_known_receiver(scene.simulation)) return "";
  return "at the level of the preset's receiver, and the receiver is another";
}

/// Empty: there is nothing to say of it.
std::string incidence_text(const Scene& scene, SampleSource source) {
  const std::string key = "render.ray_casting.incidence_correction_mm";
  const render::RayCastingOptions& o = scene.render.ray_casting;
  const bool is_chosen = !o.incidence_correction_m && o.mode != render::RenderMode::volume;
  if (!is_chosen) return "";
  if (const std::string lost = unknown_aperture(scene.probe); !lost.empty()) {
    return uncorrected_text(lost);
  }
  if (scene.is_chosen(key)) return "";
  const std::string unknown = unknown_to_correction(scene, source);
  if (unknown.empty()) return "";
  return key + " = auto takes the width of the beam " + unknown +
         ": steep surfaces may lie too near or too deep; give the key a length (0: no correction)";
}

/// Empty: there are several frames.
std::string one_frame_text(const Scene& scene) {
  if (scene.acquisition.frames_per_volume > 1) return "";
  return "acquisition.frames_per_volume = 1: the picture shows the one plane all over the fan of " +
         degrees(scene.acquisition.fan_rad) +
         " deg, as if the body were the same at every motor angle";
}

}  // namespace

std::vector<std::string> scene_warnings(const Scene& scene, SampleSource source) {
  std::vector<std::string> warnings;
  for (std::string text : {incidence_text(scene, source), one_frame_text(scene)}) {
    if (!text.empty()) warnings.push_back(std::move(text));
  }
  return warnings;
}

void warn_of_scene(const Scene& scene, SampleSource source, Progress& progress) {
  for (const std::string& text : scene_warnings(scene, source)) progress.warn(text);
  progress.warn(idle_options_text(idle_options(scene, scene.given, source)));
}

void warn_of_scenes(const std::vector<Scene>& scenes, Progress& progress) {
  std::set<std::string> said;
  IdleInAll idle;
  for (const Scene& scene : scenes) {
    for (const std::string& text : scene_warnings(scene, SampleSource::simulator)) {
      if (said.insert(text).second) progress.warn(text);
    }
    idle.add(scene, scene.given);
  }
  progress.warn(idle_options_text(idle.options()));
}

void warn_of_scan(const Scene& scene, bool is_simulated, Progress& progress) {
  if (!is_simulated) return warn_of_unused(scene, {}, "--board sim", progress);
  // A scene file has those of the renderer for commands that render what was scanned.
  std::set<std::string> keys = scene.given;
  std::erase_if(keys, [](const std::string& key) { return key.starts_with("render."); });
  progress.warn(idle_options_text(idle_options(scene, keys)));
}

void warn_of_unused(const Scene& scene,
                    const std::vector<std::string>& sections,
                    const std::string& acts_with,
                    Progress& progress) {
  std::vector<IdleOption> unused;
  for (const std::string& key : scene.given) {
    const bool is_named = std::any_of(sections.begin(), sections.end(), [&](const auto& section) {
      return key.starts_with(section);
    });
    if (sections.empty() || is_named) unused.push_back({key, acts_with});
  }
  progress.warn(idle_options_text(unused));
}

}  // namespace wobblebench::bench
