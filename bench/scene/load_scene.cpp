// A scene file and the --set options, read into a Scene and checked.
#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <sstream>
#include <system_error>

#include "base/text.h"
#include "bench/scene/available_memory.h"
#include "bench/scene/scene.h"
#include "bench/scene/scene_cost.h"
#include "bench/scene/toml_depth.h"
#include "bench/scene/toml_reader.h"
#include "sim/fidelity.h"

namespace wobblebench::bench {

namespace {

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const auto& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

void check_is_file(const std::filesystem::path& path) {
  std::error_code error;
  const auto type = std::filesystem::status(path, error).type();
  if (type == std::filesystem::file_type::regular) return;
  const bool missing = type == std::filesystem::file_type::not_found;
  const std::string reason = missing ? "no such file" : error ? error.message() : "not a file";
  throw UserError(path.string() + ": " + reason + "; a scene is a TOML file");
}

/// Larger files are no scenes.
constexpr std::uintmax_t kMostBytes = 16'000'000;

std::string text_of(const std::filesystem::path& path) {
  check_is_file(path);
  std::ifstream file(path, std::ios::binary);
  if (!file) throw UserError(path.string() + ": " + std::strerror(errno));
  std::string text(kMostBytes + 1, '\0');
  file.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(file.gcount()));
  if (text.size() <= kMostBytes) return text;
  throw UserError(path.string() + ": has more than " + std::to_string(kMostBytes / 1'000'000) +
                  " MB; a scene is a TOML file");
}

const std::string kTooDeep =
    "nests deeper than " + std::to_string(kDeepestToml) + " levels; keys of a scene have three";

toml::table parse_file(const std::filesystem::path& path) {
  if (path.empty()) return {};
  const std::string text = text_of(path);
  if (const auto line = line_nested_too_deep(text)) {
    throw UserError(path.string() + ": line " + std::to_string(*line) + ": " + kTooDeep);
  }
  try {
    return toml::parse(text, path.string());
  } catch (const toml::parse_error& error) {
    throw UserError(path.string() + ": line " + std::to_string(error.source().begin.line) + ": " +
                    std::string(error.description()));
  }
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

/// Puts "a.b.c=value" into the table of section a.b.
void apply_setting(toml::table& scene, const std::string& setting) {
  if (!is_printable_text(setting)) {
    throw UserError("--set " + setting + ": must be UTF-8 without control characters");
  }
  const auto equals = setting.find('=');
  if (line_nested_too_deep(setting.substr(0, equals)) || is_deep_value(setting, equals)) {
    throw UserError("--set " + setting + ": " + kTooDeep);
  }
  const auto last_dot = setting.rfind('.', equals);
  if (equals == std::string::npos || last_dot == std::string::npos || last_dot == 0) {
    throw UserError("--set " + setting + ": must be SECTION.KEY=VALUE");
  }
  const std::string path = "." + setting.substr(0, equals) + ".";
  if (path.find("..") != std::string::npos) {
    throw UserError("--set " + setting + ": a part of its key is empty; must be SECTION.KEY=VALUE");
  }
  toml::table* table = &scene;
  std::istringstream sections(setting.substr(0, last_dot));
  for (std::string name; std::getline(sections, name, '.');) {
    auto* node = table->get(name);
    if (!node) node = &table->insert(name, toml::table{}).first->second;
    table = node->as_table();
    if (!table) throw UserError("--set " + setting + ": " + name + " is not a section");
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
      throw UserError(source + ": " + name + ": unknown; sections are " + joined(sections));
    }
    refuse_leftovers(*node.as_table(), name, source, sections);
  }
}

void refuse_unknown_keys(const toml::table& table,
                         const std::string& section,
                         const TomlReader& reader,
                         const std::string& source) {
  for (const auto& [key, node] : table) {
    if (node.is_table()) continue;
    throw UserError(source + ": " + section + "." + std::string(key.str()) +
                    ": unknown key; keys of [" + section + "] are " + joined(reader.known_keys()));
  }
}

void read_sections(Scene& scene, toml::table& table, const std::string& source) {
  std::vector<std::string> sections;
  for_each_section(scene, [&](const std::string& section, auto& options) {
    sections.push_back(section);
    if (section == "acquisition") {
      scene.acquisition.sector_rad = hw::probe_preset(scene.probe.preset).sector_rad;
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
  check("simulation", [&] { sim::choose_fidelity(scene.simulation, scene.plan(), scene.moves()); });
  check("render", [&] { render::validate(scene.render); });
  check_memory(scene, source, available_memory_bytes());
}

}  // namespace

Scene load_scene(const std::filesystem::path& path, const std::vector<std::string>& settings) {
  toml::table table = parse_file(path);
  for (const auto& setting : settings) apply_setting(table, setting);
  std::string source = path.empty() ? "defaults" : path.string();
  if (!settings.empty()) source = path.empty() ? "--set" : source + " with --set";
  Scene scene;
  read_sections(scene, table, source);
  validate(scene, source);
  return scene;
}

}  // namespace wobblebench::bench
