#include "bench/studies/accuracy/option_tables.h"

#include <algorithm>
#include <cctype>
#include <sstream>

#include "base/user_error.h"

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

toml::table& table_at(toml::table& root, const std::string& key, const std::string& source) {
  toml::node* node = root.get(key);
  if (node == nullptr || !node->is_table() || node->as_table()->empty()) {
    refuse_plan(source, key, "must be one or more tables [" + key + ".NAME]");
  }
  return *node->as_table();
}

}  // namespace

void refuse_plan(const std::string& source, const std::string& key, const std::string& allowed) {
  throw UserError(source + ": " + key + ": " + allowed);
}

void check_option_name(const std::string& source, const std::string& key, const std::string& name) {
  const bool plain = !name.empty() && name.size() <= 40 &&
                     std::all_of(name.begin(), name.end(), [](unsigned char c) {
                       return std::isalnum(c) != 0 || c == '_' || c == '-';
                     });
  if (!plain) {
    refuse_plan(source, key + "." + name, "a name is 1 to 40 letters, digits, - and _");
  }
}

std::vector<NamedOptions> read_option_tables(toml::table& root,
                                             const std::string& key,
                                             const std::filesystem::path& path) {
  const std::string source = path.string();
  std::vector<NamedOptions> all;
  for (auto& [name, node] : table_at(root, key, source)) {
    NamedOptions options{std::string(name.str()), {}, {}};
    check_option_name(source, key, options.name);
    toml::table* table = node.as_table();
    if (table == nullptr) refuse_plan(source, key + "." + options.name, "must be a table");
    if (const toml::node* file = table->get("file"); file != nullptr && key == "scenes") {
      if (!file->is_string())
        refuse_plan(source, key + "." + options.name + ".file", "must be a text");
      options.file = path.parent_path() / file->as_string()->get();
      table->erase("file");
    }
    for (const auto& [section, inner] : *table) {
      if (key == "settings" && section.str() != "render") {
        refuse_plan(source,
                    key + "." + options.name + "." + std::string(section.str()),
                    "a setting holds [render] alone; a scan is changed in [scenes]");
      }
    }
    flatten(*table, "", path, options.settings);
    all.push_back(std::move(options));
  }
  return all;
}

}  // namespace wobblebench::bench
