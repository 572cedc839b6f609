#include "bench/scene/scene.h"

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <glm/vec3.hpp>
#include <initializer_list>
#include <iomanip>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/file.h"
#include "base/near_name.h"
#include "base/text.h"
#include "bench/scene/scene_cost.h"
#include "bench/scene/scene_text.h"
#include "bench/scene/toml_depth.h"
#include "bench/scene/toml_file.h"
#include "sim/fidelity.h"

namespace wobblebench::bench {

namespace {

/// Writes one section with the values in the units of their keys.
class JsonWriter {
 public:
  void real(std::string_view key, const double& value, double unit, double, double) {
    json_[std::string(key)] = in_unit(value, unit);
  }
  void real_or_auto(
      std::string_view key, const std::optional<double>& value, double unit, double, double) {
    auto& json = json_[std::string(key)];
    if (value) {
      json = in_unit(*value, unit);
    } else {
      json = kAuto;
    }
  }
  void integer(std::string_view key, const int& value, int, int) {
    json_[std::string(key)] = value;
  }
  void seed(std::string_view key, const std::uint64_t& value) { json_[std::string(key)] = value; }
  void flag(std::string_view key, const bool& value) { json_[std::string(key)] = value; }
  void text(std::string_view key, const std::string& value) { json_[std::string(key)] = value; }
  void texts(std::string_view key, const std::vector<std::string>& values) {
    json_[std::string(key)] = values;
  }
  void constant(std::string_view key, std::string_view text) { json_[std::string(key)] = text; }
  template <class Enum>
  void choice(std::string_view key,
              const Enum& value,
              std::initializer_list<std::pair<std::string_view, Enum>> names) {
    for (const auto& [name, candidate] : names) {
      if (candidate == value) json_[std::string(key)] = name;
    }
  }
  void reals(std::string_view key, const std::vector<double>& values, double unit, double, double) {
    auto& list = json_[std::string(key)] = nlohmann::ordered_json::array();
    for (const double value : values) list.push_back(in_unit(value, unit));
  }
  void vec3(std::string_view key, const glm::dvec3& value, double unit, double min, double max) {
    reals(key, {value.x, value.y, value.z}, unit, min, max);
  }
  const nlohmann::ordered_json& json() const { return json_; }

 private:
  /// Twelve digits: 0.16 m reads 160 mm, not 159.99999999999997.
  static double in_unit(double value, double unit) {
    std::ostringstream rounded;
    rounded << std::setprecision(12) << value / unit;
    return std::strtod(rounded.str().c_str(), nullptr);  // unlike std::stod, takes denormal numbers
  }
  nlohmann::ordered_json json_;
};

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const auto& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

/// The value of a --set: TOML as in a file, or else a bare text.
toml::table parse_value(const std::string& text) {
  try {
    return toml::parse("value = " + text);
  } catch (const toml::parse_error&) {
    toml::table table;
    table.insert("value", text);
    return table;
  }
}

/// A bare text, a path say, may hold any number of dots.
bool is_deep_value(const std::string& setting, std::size_t equals) {
  if (equals == std::string::npos) return false;
  const auto first = setting.find_first_not_of(' ', equals + 1);
  if (first == std::string::npos || (setting[first] != '[' && setting[first] != '{')) return false;
  return line_nested_too_deep(setting.substr(first)).has_value();
}

/// What a shell leaves of a list without quotes is none; what TOML reads of it is not what was
/// meant.
void refuse_broken_list(const std::string& setting,
                        std::size_t equals,
                        const std::string& given_by) {
  const auto first = setting.find_first_not_of(' ', equals + 1);
  if (first == std::string::npos || setting[first] != '[') return;
  try {
    static_cast<void>(toml::parse("value = " + setting.substr(first)));
  } catch (const toml::parse_error&) {
    const std::string key = setting.substr(0, equals);
    throw UserError(given_by + " " + setting +
                    ": its list is no TOML; in a shell, quote all of it: " + given_by + " '" + key +
                    "=[1, 2]' or '" + key + "=[\"a\", \"b\"]'");
  }
}

/// Puts "a.b.c=value" into the table of section a.b.
void apply_setting(toml::table& scene, const std::string& setting, const std::string& given_by) {
  if (!is_printable_text(setting)) {
    throw UserError(given_by + " " + setting + ": must be UTF-8 without control characters");
  }
  const auto equals = setting.find('=');
  if (line_nested_too_deep(setting.substr(0, equals)) || is_deep_value(setting, equals)) {
    throw UserError(given_by + " " + setting + ": " + too_deep_toml());
  }
  const auto last_dot = setting.rfind('.', equals);
  if (equals == std::string::npos || last_dot == std::string::npos || last_dot == 0) {
    throw UserError(given_by + " " + setting + ": must be SECTION.KEY=VALUE");
  }
  const std::string path = "." + setting.substr(0, equals) + ".";
  if (path.find("..") != std::string::npos) {
    throw UserError(given_by + " " + setting +
                    ": a part of its key is empty; must be SECTION.KEY=VALUE");
  }
  refuse_broken_list(setting, equals, given_by);
  toml::table* table = &scene;
  std::istringstream sections(setting.substr(0, last_dot));
  for (std::string name; std::getline(sections, name, '.');) {
    auto* node = table->get(name);
    if (!node) node = &table->insert(name, toml::table{}).first->second;
    table = node->as_table();
    if (!table) throw UserError(given_by + " " + setting + ": " + name + " is not a section");
  }
  const std::string key = setting.substr(last_dot + 1, equals - last_dot - 1);
  toml::table value = parse_value(setting.substr(equals + 1));
  table->insert_or_assign(key, std::move(*value.get("value")));
}

/// The table of a dotted section name, or nullptr.
toml::table* find_section(toml::table& scene,
                          const std::string& section,
                          const std::string& source) {
  toml::node* node = &scene;
  std::istringstream names(section);
  for (std::string name; std::getline(names, name, '.');) {
    node = node->as_table()->get(name);
    if (!node) return nullptr;
    if (!node->is_table())
      throw UserError(source + ": " + section + ": must be a section [" + section + "]");
  }
  return node->as_table();
}

/// Once all sections are read, only empty tables may be left.
void refuse_leftovers(const toml::table& table,
                      const std::string& path,
                      const std::string& source,
                      const std::vector<std::string>& sections) {
  for (const auto& [key, node] : table) {
    const std::string name =
        path.empty() ? std::string(key.str()) : path + "." + std::string(key.str());
    const bool is_section_or_parent =
        std::any_of(sections.begin(), sections.end(), [&](const auto& section) {
          return section == name || section.starts_with(name + ".");
        });
    if (!node.is_table() || !is_section_or_parent) {
      throw UserError(source + ": " + name + ": unknown; sections are " + joined(sections) +
                      did_you_mean(name, sections));
    }
    refuse_leftovers(*node.as_table(), name, source, sections);
  }
}

/// Of the section's own keys, or else of those with just this name in another section.
std::string did_you_mean_key(const std::string& key, const std::vector<std::string>& known) {
  std::string near = did_you_mean(key, known);
  if (!near.empty()) return near;
  std::vector<std::string> names, keys;
  const Scene defaults;
  for_each_section(defaults, [&](const std::string& section, const auto& options) {
    JsonWriter writer;
    describe(options, writer);
    for (const auto& [name, value] : writer.json().items()) {
      names.push_back(name);
      keys.push_back(section + "." + name);
    }
  });
  const auto found = std::find(names.begin(), names.end(), nearest_name(key, names));
  if (found == names.end()) return "";
  return "; did you mean " + keys[static_cast<std::size_t>(found - names.begin())] + "?";
}

void refuse_unknown_keys(const toml::table& table,
                         const std::string& section,
                         const TomlReader& reader,
                         const std::string& source) {
  for (const auto& [key, node] : table) {
    if (node.is_table()) continue;
    throw UserError(source + ": " + section + "." + std::string(key.str()) +
                    ": unknown key; keys of [" + section + "] are " + joined(reader.known_keys()) +
                    did_you_mean_key(std::string(key.str()), reader.known_keys()));
  }
}

void read_sections(Scene& scene, toml::table& table, const std::string& source) {
  std::vector<std::string> sections;
  for_each_section(scene, [&](const std::string& section, auto& options) {
    sections.push_back(section);
    if (section == "acquisition") {
      scene.acquisition.sector_rad = hw::probe_preset(scene.probe.preset).sector_rad;
    }
    if (section == "render.pipeline") {
      scene.render = render::render_preset(scene.picture.preset);
    }
    if (toml::table* found = find_section(table, section, source)) {
      TomlReader reader(source, section, *found);
      describe(options, reader);
      refuse_unknown_keys(*found, section, reader, source);
      scene.given.insert(reader.given_keys().begin(), reader.given_keys().end());
    }
    try {
      check_options(options);
    } catch (const InvalidOption& error) {
      throw UserError(source + ": " + section + "." + error.what());
    }
  });
  refuse_leftovers(table, "", source, sections);
}

/// A table of JSON as TOML: numbers, texts and lists are written alike. Null is left out.
void write_toml(const nlohmann::ordered_json& table, const std::string& name, std::string& toml) {
  if (!name.empty()) toml += "[" + name + "]\n";
  for (const auto& [key, value] : table.items()) {
    if (!value.is_object() && !value.is_null()) toml += key + " = " + value.dump() + "\n";
  }
  for (const auto& [key, value] : table.items()) {
    if (value.is_object()) write_toml(value, name.empty() ? key : name + "." + key, toml);
  }
}

toml::table table_of(const nlohmann::ordered_json& resolved, const std::string& source) {
  std::string text;
  write_toml(resolved, "", text);
  try {
    return toml::parse(text);
  } catch (const toml::parse_error& error) {
    throw UserError(source + ": its scene cannot be read: " + std::string(error.description()));
  }
}

toml::table with_settings(toml::table table,
                          const std::vector<std::string>& settings,
                          const std::string& settings_of) {
  for (const auto& setting : settings) apply_setting(table, setting, settings_of);
  return table;
}

bool is_report(const std::filesystem::path& path) {
  return path.extension() == ".json";
}

/// The scene of a report that another command has written.
toml::table reported_table(const std::filesystem::path& path) {
  const auto refuse = [&](const char* why) { throw UserError(path.string() + ": " + why); };
  const auto report = nlohmann::ordered_json::parse(read_file(path), nullptr, false);
  const auto scene = report.is_object() ? report.value("scene", nlohmann::ordered_json()) : nullptr;
  if (!scene.is_object()) {
    refuse("has no \"scene\"; must be a scene in TOML, or report.json or recording.json of one");
  }
  if (!scene.contains("phantom") || scene["phantom"].is_null()) {
    refuse("has no phantom in its \"scene\": the subject of its samples is not known");
  }
  return table_of(scene, path.string());
}

/// The file's table. Refuses settings first where they alone are wrong: what a shell made of a list
/// may stand as the path.
toml::table file_table(const std::filesystem::path& path,
                       const std::vector<std::string>& settings,
                       const std::string& settings_of) {
  with_settings({}, settings, settings_of);
  if (path.empty()) return {};
  return is_report(path) ? reported_table(path) : parse_toml_file(path, "a scene");
}

/// Another program blends no volume.
void seek_surface_alone(Scene& scene) {
  if (scene.picture.program.empty()) return;
  scene.render.ray_casting.mode = render::RenderMode::surface;
}

/// The rung geometry has no beam, whose width would have to be corrected.
void correct_no_beam(Scene& scene) {
  auto& length_m = scene.render.ray_casting.incidence_correction_m;
  if (scene.simulation.fidelity == sim::Rung::geometry && !length_m) length_m = 0;
}

/// Rules between options, checked by each module.
void validate(const Scene& scene, const std::string& source) {
  const auto check = [&](const std::string& section, const auto& rule) {
    try {
      rule();
    } catch (const InvalidOption& error) {
      throw UserError(source + ": " + section + "." + error.what());
    } catch (const phantoms::InvalidPhantom& error) {
      throw UserError(source + ": " + section + "." + error.what());
    }
  };
  check("phantom", [&] { phantoms::validate(scene.phantom); });
  check("motion", [&] { phantoms::validate(scene.motion); });
  check("probe", [&] { hw::validate(scene.probe); });
  check("acquisition", [&] { static_cast<void>(scene.plan()); });
  check("simulation", [&] { sim::choose_fidelity(scene.simulation, scene.plan(), scene.moves()); });
  check("render", [&] { render::validate(scene.render); });
  check_memory(scene, source, available_memory_bytes());
}

}  // namespace

bool Scene::moves() const {
  // As if the phantom had a joint and a mouth of any size: whether it does is not known yet.
  phantoms::Joint joint;
  joint.mouth = phantoms::Mouth{.opening_m = 1, .reach_m = 1};
  return !phantoms::Motion(motion, joint).still();
}

void refuse_program(const Scene& scene, const std::string& command) {
  if (scene.picture.program.empty()) return;
  throw UserError("render.program = " + scene.picture.program + ": must be empty; `" + command +
                  "` measures our own renderer; `run`, `accuracy`, `trade` and `tune` take others");
}

std::map<std::string, std::string> values_by_key(const nlohmann::ordered_json& resolved) {
  std::map<std::string, std::string> values;
  const nlohmann::ordered_json flat = resolved.flatten();
  for (const auto& [pointer, value] : flat.items()) {
    std::string key = pointer.substr(1);
    std::ranges::replace(key, '/', '.');
    values[key] = value.dump();
  }
  return values;
}

nlohmann::ordered_json resolved(const Scene& scene) {
  nlohmann::ordered_json json;
  for_each_section(scene, [&](const std::string& section, const auto& options) {
    JsonWriter writer;
    describe(options, writer);
    const auto dot = section.find('.');
    auto& entry = dot == std::string::npos ? json[section]
                                           : json[section.substr(0, dot)][section.substr(dot + 1)];
    entry = writer.json();
  });
  return json;
}

namespace {

/// `of_report`: the table names every option.
Scene scene_of(const toml::table& file,
               const std::vector<std::string>& settings,
               const std::string& settings_of,
               const std::string& source,
               render::RenderPreset preset,
               bool of_report) {
  toml::table table = with_settings(file, settings, settings_of);
  Scene scene;
  scene.picture.preset = preset;
  read_sections(scene, table, source);
  seek_surface_alone(scene);
  correct_no_beam(scene);
  validate(scene, source);
  if (!of_report) return scene;
  scene.reported = scene.given;
  for (const auto& setting : settings) scene.reported.erase(setting.substr(0, setting.find('=')));
  // What commands set themselves unless a user does; several volumes were somebody's choice.
  for (const char* key : {"simulation.fidelity", "simulation.seed", "simulation.side_lobes"}) {
    if (scene.reported.contains(key)) scene.given.erase(key);
  }
  if (scene.acquisition.volumes == 1 && scene.reported.contains("acquisition.volumes")) {
    scene.given.erase("acquisition.volumes");
  }
  return scene;
}

}  // namespace

SceneSource scene_source(const std::filesystem::path& path,
                         const std::vector<std::string>& first,
                         const std::string& settings_of,
                         render::RenderPreset preset) {
  return
      [=, file = file_table(path, first, settings_of)](const std::vector<std::string>& settings) {
        std::string source = path.empty() ? "defaults" : path.string();
        if (!settings.empty())
          source = path.empty() ? settings_of : source + " with " + settings_of;
        return scene_of(file, settings, settings_of, source, preset, is_report(path));
      };
}

Scene load_scene(const std::filesystem::path& path,
                 const std::vector<std::string>& settings,
                 const std::string& settings_of,
                 render::RenderPreset preset) {
  return scene_source(path, settings, settings_of, preset)(settings);
}

std::string scene_text(const std::filesystem::path& path,
                       const std::vector<std::string>& settings) {
  std::ostringstream text;
  text << with_settings(file_table(path, settings, "--set"), settings, "--set") << "\n";
  return text.str();
}

Scene load_resolved_scene(const nlohmann::ordered_json& resolved,
                          const std::vector<std::string>& settings,
                          const std::string& source) {
  return scene_of(table_of(resolved, source),
                  settings,
                  "--set",
                  settings.empty() ? source : source + " with --set",
                  render::RenderPreset::accurate,
                  true);
}

}  // namespace wobblebench::bench
