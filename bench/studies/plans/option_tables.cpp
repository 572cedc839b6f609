#include "bench/studies/plans/option_tables.h"

#include <algorithm>
#include <cctype>
#include <sstream>

#include "base/near_name.h"
#include "base/user_error.h"
#include "bench/scene/toml_file.h"

namespace wobblebench::bench {

namespace {

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

/// `options.file` is the scene that [scenes.NAME] begins from, if it names one.
void take_file(toml::table& table, const std::filesystem::path& path, NamedOptions& options) {
  const toml::node* file = table.get("file");
  if (file == nullptr) return;
  if (!file->is_string()) {
    refuse_plan(path.string(), "scenes." + options.name + ".file", "must be a text");
  }
  options.file = path.parent_path() / file->as_string()->get();
  table.erase("file");
}

/// The table [KEY.NAME].
NamedOptions read_options(toml::node& node,
                          const std::string& key,
                          const std::string& name,
                          const std::filesystem::path& path) {
  const std::string source = path.string();
  check_option_name(source, key, name);
  NamedOptions options{name, {}, {}};
  toml::table* table = node.as_table();
  if (table == nullptr) refuse_plan(source, key + "." + name, "must be a table");
  if (key == "scenes") take_file(*table, path, options);
  for (const auto& [section, inner] : *table) {
    if (key == "settings" && section.str() != "render") {
      refuse_plan(source,
                  key + "." + name + "." + std::string(section.str()),
                  "a setting holds [render] alone; a scan is changed in [scenes]");
    }
  }
  flatten(*table, "", path, options.settings);
  return options;
}

}  // namespace

void check_option_name(const std::string& source, const std::string& key, const std::string& name) {
  const bool plain = !name.empty() && name.size() <= 40 &&
                     std::all_of(name.begin(), name.end(), [](unsigned char c) {
                       return std::isalnum(c) != 0 || c == '_' || c == '-';
                     });
  if (!plain) {
    refuse_plan(source, key + "." + name, "a name is 1 to 40 letters, digits, - and _");
  }
}

void refuse_plan(const std::string& source, const std::string& key, const std::string& allowed) {
  throw UserError(source + ": " + key + ": " + allowed);
}

void refuse_unknown_keys(const std::vector<std::string>& given,
                         const std::vector<std::string>& known,
                         const std::string& source) {
  for (const std::string& key : given) {
    if (std::find(known.begin(), known.end(), key) != known.end()) continue;
    std::string names;
    for (const std::string& name : known) names += (names.empty() ? "" : ", ") + name;
    refuse_plan(source, key, "unknown; keys of a plan are " + names + did_you_mean(key, known));
  }
}

std::vector<NamedOptions> load_option_tables(const std::filesystem::path& path,
                                             const std::string& key) {
  toml::table root = parse_toml_file(path, "a list of " + key);
  toml::table* tables = root[key].as_table();
  if (tables == nullptr || tables->empty()) {
    refuse_plan(path.string(), key, "must be one or more tables [" + key + ".NAME]");
  }
  std::vector<NamedOptions> all;
  for (auto& [name, node] : *tables) {
    all.push_back(read_options(node, key, std::string(name.str()), path));
  }
  return all;
}

NamedOptions load_option_table(const std::filesystem::path& path, const std::string& key) {
  toml::table root = parse_toml_file(path, "a plan");
  toml::table* table = root[key].as_table();
  return table == nullptr ? NamedOptions{key, {}, {}} : read_options(*table, "scenes", key, path);
}

std::string plain_value(const std::string& value) {
  const bool quoted = value.size() >= 2 && value.front() == value.back() &&
                      (value.front() == '"' || value.front() == '\'');
  return quoted ? value.substr(1, value.size() - 2) : value;
}

}  // namespace wobblebench::bench
