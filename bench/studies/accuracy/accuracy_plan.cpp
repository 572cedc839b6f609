#include "bench/studies/accuracy/accuracy_plan.h"

#include <algorithm>
#include <numeric>

#include "bench/scene/toml_file.h"
#include "bench/studies/accuracy/option_tables.h"
#include "sim/fidelity.h"

namespace wobblebench::bench {

namespace {

constexpr const char* kSectionOfPlan = "plan";

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

void refuse_unknown(const toml::table& root, const TomlReader& reader, const std::string& source) {
  for (const auto& [key, node] : root) {
    if (key.str() == "scenes" || key.str() == "settings") continue;
    std::string known = "scenes, settings";
    for (const std::string& name : reader.known_keys()) known += ", " + name;
    refuse_plan(source, std::string(key.str()), "unknown; keys of a plan are " + known);
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

}  // namespace

std::vector<std::uint64_t> seed_list(std::uint64_t first, int count) {
  std::vector<std::uint64_t> seeds(static_cast<std::size_t>(count));
  std::iota(seeds.begin(), seeds.end(), first);
  return seeds;
}

bool is_accuracy_plan(const std::filesystem::path& path) {
  const toml::table root = parse_toml_file(path, "a plan or a scene");
  return root.contains("scenes") || root.contains("settings");
}

AccuracyPlan load_accuracy_plan(const std::filesystem::path& path) {
  const std::string source = path.string();
  toml::table root = parse_toml_file(path, "a plan");
  PlanOptions options;
  TomlReader reader(source, kSectionOfPlan, root);
  describe(options, reader);
  refuse_unknown(root, reader, source);
  AccuracyPlan plan{source,
                    seed_list(options.first_seed, options.seeds),
                    read_rungs(options.rungs, source),
                    read_option_tables(root, "scenes", path),
                    read_option_tables(root, "settings", path)};
  put_first(plan.settings, options.reference, source);
  return plan;
}

std::vector<NamedOptions> load_settings(const std::filesystem::path& path) {
  toml::table root = parse_toml_file(path, "a list of settings");
  return read_option_tables(root, "settings", path);
}

AccuracyPlan accuracy_plan_of_scene(const std::filesystem::path& path,
                                    const std::vector<std::string>& settings) {
  const Scene scene = load_scene(path, settings);
  const std::string name = path.empty() ? "default" : path.stem().string();
  const std::string source = path.empty() ? "--set" : path.string();
  check_option_name(source, "scene", name);
  return {source,
          seed_list(scene.simulation.seed, PlanOptions{}.seeds),
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

}  // namespace wobblebench::bench
