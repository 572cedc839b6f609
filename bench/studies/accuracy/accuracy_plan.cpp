#include "bench/studies/accuracy/accuracy_plan.h"

#include <algorithm>
#include <cctype>

#include "base/text.h"
#include "base/user_error.h"
#include "bench/evaluation/seed_statistics.h"
#include "bench/exchange/program/renderer_process.h"
#include "bench/scene/toml_file.h"
#include "bench/studies/dataset/drawn_scenes.h"
#include "sim/fidelity.h"

namespace wobblebench::bench {

namespace {

struct PlanOptions {
  int seeds = 10;
  std::uint64_t first_seed = 1;
  std::vector<std::string> rungs = {"field", "scatterers"};
  std::string reference;
};

template <OptionsOf<PlanOptions> O, class Visitor>
void describe(O& o, Visitor& v) {
  v.integer("seeds", o.seeds, 1, kMostSeeds);
  v.seed("first_seed", o.first_seed);
  v.texts("rungs", o.rungs);
  v.text("reference", o.reference);
}

std::vector<sim::Rung> read_rungs(const std::vector<std::string>& names,
                                  const std::string& source) {
  std::vector<sim::Rung> rungs;
  for (const std::string& name : names) {
    const auto& all = {sim::Rung::automatic,
                       sim::Rung::geometry,
                       sim::Rung::field,
                       sim::Rung::scatterers,
                       sim::Rung::reference};
    const auto found = std::find_if(
        all.begin(), all.end(), [&](sim::Rung rung) { return sim::to_string(rung) == name; });
    if (found == all.end()) {
      refuse_plan(source,
                  "rungs = " + name,
                  "must be of \"auto\" \"geometry\" \"field\" \"scatterers\" \"reference\"");
    }
    if (std::find(rungs.begin(), rungs.end(), *found) != rungs.end()) {
      refuse_plan(source, "rungs = " + name, "is there twice");
    }
    rungs.push_back(*found);
  }
  if (rungs.empty()) refuse_plan(source, "rungs = []", "must name one or more");
  return rungs;
}

void put_first(std::vector<NamedOptions>& settings,
               const std::string& reference,
               const std::string& source) {
  if (reference.empty()) return;
  const auto found = std::find_if(settings.begin(), settings.end(), [&](const auto& setting) {
    return setting.name == reference;
  });
  if (found == settings.end()) {
    refuse_plan(source, "reference = \"" + reference + "\"", "must be one of [settings]");
  }
  std::rotate(settings.begin(), found, found + 1);
}

/// The scenes of a population in place of those of a plan.
void draw_scenes(const DrawnOptions& options,
                 const std::filesystem::path& path,
                 AccuracyPlan& plan) {
  for (NamedDrawnScene& drawn : drawn_scenes(options, options.half, path)) {
    plan.drawn.push_back({drawn.stratum, drawn.seed});
    plan.scenes.push_back(std::move(drawn.scene));
  }
}

/// These are varied by the plan.
void refuse_varied(const Scene& scene, const std::string& source) {
  for (const char* key : {"simulation.fidelity", "simulation.seed"}) {
    if (scene.given.contains(key)) {
      refuse_plan(source, key, "is set by the study itself; leave it out");
    }
  }
  if (scene.acquisition.volumes != 1) {
    refuse_plan(source, "acquisition.volumes", "must be 1; this command renders one volume");
  }
}

/// A setting as a shell's word; without TOML's quotes where the text cannot be taken for anything
/// else.
std::string setting_word(const std::string& setting) {
  const auto equals = setting.find('=');
  const std::string value = plain_value(setting.substr(equals + 1));
  const bool is_word = !value.empty() && std::isalpha(static_cast<unsigned char>(value[0])) != 0 &&
                       std::all_of(value.begin(), value.end(), [](unsigned char c) {
                         return std::isalnum(c) != 0 || c == '_' || c == '-';
                       });
  const bool is_reserved = value == "true" || value == "false" || value == "inf" || value == "nan";
  const bool is_plain = is_word && !is_reserved;
  return shell_word(is_plain ? setting.substr(0, equals + 1) + value : setting);
}

}  // namespace

bool is_accuracy_plan(const std::filesystem::path& path) {
  if (path.extension() == ".json") return false;  // the report of a scene
  const toml::table root = parse_toml_file(path, "a plan or a scene");
  return root.contains("scenes") || root.contains("settings");
}

AccuracyPlan load_accuracy_plan(const std::filesystem::path& path) {
  const std::string source = path.string();
  toml::table root = parse_toml_file(path, "a plan");
  PlanOptions options;
  TomlReader reader(source, "plan", root);
  describe(options, reader);
  DrawnOptions drawn;
  describe(drawn, reader);
  std::vector<std::string> given, known{"scenes", "settings"};
  for (const auto& [key, node] : root) given.emplace_back(key.str());
  for (const std::string& key : reader.known_keys()) known.push_back(key);
  refuse_unknown_keys(given, known, source);
  // The reader has taken its own keys, "plan.seeds", out of `root`.
  for (const std::string& key : reader.given_keys()) given.push_back(key.substr(key.find('.') + 1));
  check_drawn_keys(drawn, given, {"seeds", "first_seed", "scenes"}, source);
  AccuracyPlan plan{
      source,
      seeds_from(options.first_seed, options.seeds),
      read_rungs(options.rungs, source),
      drawn.given() ? std::vector<NamedOptions>() : load_option_tables(path, "scenes"),
      load_option_tables(path, "settings")};
  if (drawn.given()) draw_scenes(drawn, path, plan);
  put_first(plan.settings, options.reference, source);
  return plan;
}

AccuracyPlan accuracy_plan_of_scene(const std::filesystem::path& path,
                                    const std::vector<std::string>& settings) {
  const Scene scene = load_scene(path, settings);
  const std::string name = path.empty() ? "default" : path.stem().string();
  const std::string source = path.empty() ? "--set" : path.string();
  check_option_name(source, "scene", name);
  return {source,
          seeds_from(scene.simulation.seed, PlanOptions{}.seeds),
          {scene.simulation.fidelity},
          {{name, path, {}}},
          {{"scene", {}, {}}},
          true};
}

Scene planned_scene(const AccuracyPlan& plan,
                    const NamedOptions& scene,
                    const NamedOptions& setting,
                    sim::Rung rung,
                    const std::vector<std::string>& more) {
  auto settings = scene.settings;
  settings.insert(settings.end(), setting.settings.begin(), setting.settings.end());
  settings.insert(settings.end(), more.begin(), more.end());
  const std::string source =
      plan.source + " (scene " + scene.name + ", setting " + setting.name + ")";
  Scene planned = load_scene(scene.file, settings, source);
  if (!plan.of_one_scene) refuse_varied(planned, source);
  settings.push_back("simulation.fidelity=" + sim::to_string(rung));
  return load_scene(scene.file, settings, source);
}

std::string run_command_line(const std::filesystem::path& scene,
                             const std::vector<std::string>& settings) {
  std::string command = "wobblebench run";
  if (!scene.empty()) command.append(" ").append(shell_word(scene.string()));
  for (const std::string& setting : settings) {
    command.append(" --set ").append(setting_word(setting));
    constexpr std::string_view kProgram = "render.program=";
    if (!setting.starts_with(kProgram)) continue;
    const std::string name = plain_value(setting.substr(kProgram.size()));
    if (const std::string* program = defined_renderer(name)) {
      command.append(" --renderer ").append(shell_word(std::string(name) + "=" + *program));
    }
  }
  return command;
}

}  // namespace wobblebench::bench
