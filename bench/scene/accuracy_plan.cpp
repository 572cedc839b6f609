#include "bench/scene/accuracy_plan.h"

#include <algorithm>
#include <cctype>
#include <numeric>
#include <sstream>

#include "bench/scene/toml_file.h"
#include "bench/scene/toml_reader.h"
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

[[noreturn]] void refuse(const std::string& source,
                         const std::string& key,
                         const std::string& allowed) {
  throw UserError(source + ": " + key + ": " + allowed);
}

/// Names become parts of files' names.
void check_name(const std::string& source, const std::string& key, const std::string& name) {
  const bool plain = !name.empty() && name.size() <= 40 &&
                     std::all_of(name.begin(), name.end(), [](unsigned char c) {
                       return std::isalnum(c) != 0 || c == '_' || c == '-';
                     });
  if (!plain) {
    refuse(source, key + "." + name, "a name is 1 to 40 letters, digits, - and _");
  }
}

std::string text_of(const toml::node& node) {
  std::ostringstream text;
  node.visit([&](const auto& value) { text << value; });
  std::string line = text.str();
  // Long arrays are broken into lines.
  std::replace(line.begin(), line.end(), '\n', ' ');
  return line;
}

/// A relative path of a phantom's file, from the plan's folder.
std::string beside(const std::filesystem::path& plan, const toml::node& node) {
  const std::filesystem::path given = node.as_string()->get();
  if (given.empty() || given.is_absolute()) return text_of(node);
  std::ostringstream text;
  text << toml::value<std::string>((plan.parent_path() / given).string());
  return text.str();
}

/// Each value of a table as "section.key=value".
void flatten(const toml::table& table,
             const std::string& prefix,
             const std::filesystem::path& plan,
             std::vector<std::string>& settings) {
  for (const auto& [key, node] : table) {
    const std::string name = prefix + std::string(key.str());
    if (const auto* inner = node.as_table()) {
      flatten(*inner, name + ".", plan, settings);
      continue;
    }
    const bool is_file =
        node.is_string() && (name == "phantom.file" || name == "phantom.scatterers");
    settings.push_back(name + "=" + (is_file ? beside(plan, node) : text_of(node)));
  }
}

toml::table& table_at(toml::table& root, const std::string& key, const std::string& source) {
  toml::node* node = root.get(key);
  if (node == nullptr || !node->is_table() || node->as_table()->empty()) {
    refuse(source, key, "must be one or more tables [" + key + ".NAME]");
  }
  return *node->as_table();
}

std::vector<NamedOptions> read_tables(toml::table& root,
                                      const std::string& key,
                                      const std::filesystem::path& path) {
  const std::string source = path.string();
  std::vector<NamedOptions> all;
  for (auto& [name, node] : table_at(root, key, source)) {
    NamedOptions options{std::string(name.str()), {}, {}};
    check_name(source, key, options.name);
    toml::table* table = node.as_table();
    if (table == nullptr) refuse(source, key + "." + options.name, "must be a table");
    if (const toml::node* file = table->get("file"); file != nullptr && key == "scenes") {
      if (!file->is_string()) refuse(source, key + "." + options.name + ".file", "must be a text");
      options.file = path.parent_path() / file->as_string()->get();
      table->erase("file");
    }
    for (const auto& [section, inner] : *table) {
      if (key == "settings" && section.str() != "render") {
        refuse(source,
               key + "." + options.name + "." + std::string(section.str()),
               "a setting holds [render] alone; a scan is changed in [scenes]");
      }
    }
    flatten(*table, "", path, options.settings);
    all.push_back(std::move(options));
  }
  return all;
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
      refuse(source,
             "rungs = " + name,
             "must be of \"auto\" \"geometry\" \"field\" \"scatterers\" \"reference\"");
    }
    if (std::find(rungs.begin(), rungs.end(), *found) != rungs.end()) {
      refuse(source, "rungs = " + name, "is there twice");
    }
    rungs.push_back(*found);
  }
  if (rungs.empty()) refuse(source, "rungs = []", "must name one or more");
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
    refuse(source, "reference = \"" + reference + "\"", "must be one of [settings]");
  }
  std::rotate(settings.begin(), found, found + 1);
}

void refuse_unknown(const toml::table& root, const TomlReader& reader, const std::string& source) {
  for (const auto& [key, node] : root) {
    if (key.str() == "scenes" || key.str() == "settings") continue;
    std::string known = "scenes, settings";
    for (const std::string& name : reader.known_keys()) known += ", " + name;
    refuse(source, std::string(key.str()), "unknown; keys of a plan are " + known);
  }
}

/// These are varied by the plan.
void refuse_varied(const Scene& scene, const std::string& source) {
  for (const char* key : {"simulation.fidelity", "simulation.seed"}) {
    if (scene.given.contains(key)) {
      refuse(source, key, "is set by the study itself; leave it out");
    }
  }
  if (scene.acquisition.volumes != 1) {
    refuse(source, "acquisition.volumes", "must be 1; this command renders one volume");
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
                    read_tables(root, "scenes", path),
                    read_tables(root, "settings", path)};
  put_first(plan.settings, options.reference, source);
  return plan;
}

std::vector<NamedOptions> load_settings(const std::filesystem::path& path) {
  toml::table root = parse_toml_file(path, "a list of settings");
  return read_tables(root, "settings", path);
}

AccuracyPlan accuracy_plan_of_scene(const std::filesystem::path& path,
                                    const std::vector<std::string>& settings) {
  const Scene scene = load_scene(path, settings);
  const std::string name = path.empty() ? "default" : path.stem().string();
  const std::string source = path.empty() ? "--set" : path.string();
  check_name(source, "scene", name);
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
