#include "bench/evaluation/error_model/correction.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>
#include <utility>

#include "base/file.h"
#include "base/number_text.h"
#include "base/user_error.h"
#include "render/camera.h"

namespace wobblebench::bench {

namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kKind = "wobblebench depth correction";
constexpr int kCorrectionSchema = 1;
constexpr double kStepTolerance = 0.1;
constexpr std::size_t kMostBytes = 1'000'000;

/// Keys that do not move a detected surface.
const std::set<std::string> kIndifferent = {"acquisition.volumes",
                                            "probe.preset_source",
                                            "render.correction",
                                            "render.ray_casting.mode",
                                            "render.ray_casting.image_size",
                                            "render.ray_casting.stop_at_box",
                                            "render.ray_casting.stop_on_leaving_cone",
                                            "render.ray_casting.opacity_limit",
                                            "render.ray_casting.transfer_values",
                                            "render.ray_casting.transfer_opacity_per_mm",
                                            "render.ray_casting.transfer_grey"};
const std::set<std::string> kIndifferentSections = {"render.pipeline",
                                                    "render.volume_of_interest",
                                                    "render.view",
                                                    "render.shading",
                                                    "render.smoothing"};
const std::set<std::string> kDisplayKeys = {
    "tgc_db_per_cm_mhz", "full_scale_db", "dynamic_range_db", "low_pass"};

void add_keys(const Json& from, const std::string& prefix, CorrectionConditions& conditions) {
  for (const auto& [key, value] : from.items()) {
    const std::string name = prefix + "." + key;
    if (kIndifferent.contains(name) || kIndifferentSections.contains(name)) continue;
    if (value.is_object()) {
      add_keys(value, name, conditions);
    } else {
      conditions[name] = value.dump();
    }
  }
}

template <std::size_t N>
Json terms_json(const std::array<FittedTerm, N>& terms,
                const std::array<TermDescription, N>& descriptions) {
  Json list = Json::array();
  for (std::size_t i = 0; i < N; ++i) {
    list.push_back({{"name", descriptions[i].name},
                    {"unit", descriptions[i].unit},
                    {"value", terms[i].value},
                    {"low", terms[i].low},
                    {"high", terms[i].high},
                    {"fitted", terms[i].fitted}});
  }
  return list;
}

/// By name; a term that the file lacks is 0. Throws nlohmann's exceptions.
template <std::size_t N>
void read_terms(const Json& list,
                const std::array<TermDescription, N>& descriptions,
                std::array<FittedTerm, N>& terms) {
  for (const Json& term : list) {
    const auto name = term.at("name").get<std::string>();
    const auto found = std::find_if(
        descriptions.begin(), descriptions.end(), [&](const auto& d) { return name == d.name; });
    if (found == descriptions.end()) throw std::runtime_error("term \"" + name + "\"");
    FittedTerm& read = terms[static_cast<std::size_t>(found - descriptions.begin())];
    read.value = term.at("value").get<double>();
    read.low = term.value("low", read.value);
    read.high = term.value("high", read.value);
    read.fitted = term.value("fitted", true);
    if (!std::isfinite(read.value)) throw std::runtime_error("term \"" + name + "\"");
  }
}

std::string source_of(const Scene& scene) {
  return "render.correction = " + scene.picture.correction;
}

std::string text_of(const Scene& scene) {
  std::error_code error;
  const std::filesystem::path path = scene.picture.correction;
  if (!std::filesystem::is_regular_file(path, error)) {
    throw UserError(source_of(scene) + ": no such file; must be a correction.json of `fit`");
  }
  std::string text = read_file(path, kMostBytes + 1);
  if (text.size() <= kMostBytes) return text;
  throw UserError(source_of(scene) + ": is too large; must be a correction.json of `fit`");
}

Correction parse(const Scene& scene) {
  const std::string text = text_of(scene);
  try {
    const Json json = Json::parse(text);
    if (json.at("kind") != kKind || json.at("schema") != kCorrectionSchema) {
      throw std::runtime_error("kind");
    }
    Correction correction;
    for (const auto& [key, value] : json.at("made_for").items()) {
      correction.made_for[key] = value.dump();
    }
    correction.step_mm = json.at("step_mm").get<double>();
    read_terms(json.at("terms"), error_terms(), correction.model.bias);
    read_terms(json.at("spread_terms"), spread_term_descriptions(), correction.model.spread);
    return correction;
  } catch (const UserError&) {
    throw;
  } catch (const std::exception&) {
    throw UserError(source_of(scene) + ": is not a correction; must be a correction.json of `fit`");
  }
}

void check_conditions(const Correction& correction, const Scene& scene) {
  const CorrectionConditions here = correction_conditions(scene);
  const auto value_in = [](const CorrectionConditions& conditions, const std::string& key) {
    const auto found = conditions.find(key);
    return found == conditions.end() ? "nothing" : found->second;
  };
  const auto check = [&](const std::string& key) {
    const std::string made = value_in(correction.made_for, key), is = value_in(here, key);
    if (made == is) return;
    throw UserError(source_of(scene) + ": was made for " + key + " = " + made + "; the scene has " +
                    is + ", and must have the same");
  };
  check("probe.preset");  // which the other keys of the probe follow
  for (const auto& [key, value] : here) check(key);
  for (const auto& [key, value] : correction.made_for) check(key);
}

}  // namespace

CorrectionConditions correction_conditions(const Scene& scene) {
  const Json all = resolved(scene);
  CorrectionConditions conditions;
  for (const char* section : {"probe", "acquisition", "render"}) {
    add_keys(all.at(section), section, conditions);
  }
  conditions["render.shading.depth_filter_size"] =
      all.at("render").at("shading").at("depth_filter_size").dump();
  for (const std::string& key : kDisplayKeys) {
    conditions["simulation." + key] = all.at("simulation").at(key).dump();
  }
  return conditions;
}

std::string correction_text(const Correction& correction) {
  Json made_for = Json::object();
  for (const auto& [key, value] : correction.made_for) made_for[key] = Json::parse(value);
  const Json json = {
      {"kind", kKind},
      {"schema", kCorrectionSchema},
      {"terms", terms_json(correction.model.bias, error_terms())},
      {"spread_terms", terms_json(correction.model.spread, spread_term_descriptions())},
      {"step_mm", correction.step_mm},
      {"made_for", made_for}};
  return json.dump(2) + "\n";
}

std::optional<Correction> read_correction(const Scene& scene, bool knows_scan) {
  if (scene.picture.correction.empty()) return {};
  Correction correction = parse(scene);
  if (knows_scan) check_conditions(correction, scene);
  return correction;
}

void check_correction(const Correction& correction, const Scene& scene) {
  check_conditions(correction, scene);
  const double here_mm = render::step_m(scene.render) / kMillimetre;
  if (std::abs(here_mm / correction.step_mm - 1) <= kStepTolerance) return;
  throw UserError(source_of(scene) + ": was made for steps of " + fixed(correction.step_mm, 4) +
                  " mm; render.volume_of_interest and render.ray_casting.steps make them " +
                  fixed(here_mm, 4) + " mm, and must make them the same within 10 %");
}

Image<float> corrected_depth(const DetectionModel& model,
                             const TermMeter& meter,
                             const render::CastDepth& depth,
                             const hw::PolarVolume& volume) {
  const Image<PixelTerms> terms = meter.measure(depth.filtered_m, volume);
  Image<float> corrected_m = depth.depth_m;
  for (std::size_t i = 0; i < corrected_m.pixels.size(); ++i) {
    if (!terms.pixels[i].measured) continue;
    corrected_m.pixels[i] -= static_cast<float>(model.bias_m(terms.pixels[i]));
  }
  return corrected_m;
}

render::Picture corrected_picture(const Correction& correction,
                                  render::Renderer& renderer,
                                  const render::Picture& uncorrected,
                                  const hw::PolarVolume& volume,
                                  const Scene& scene) {
  const TermMeter meter(volume.plan(), scene.simulation, scene.render);
  render::RenderTaps taps;
  taps.depth = [&](const render::CastDepth& depth) {
    return corrected_depth(correction.model, meter, depth, volume);
  };
  renderer.set_taps(taps);
  render::Picture corrected = renderer.render();
  renderer.set_taps({});
  corrected.passes.front() = uncorrected.passes.front();
  return corrected;
}

}  // namespace wobblebench::bench
