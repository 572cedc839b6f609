// Tables of options in a plan, which several studies read alike.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace wobblebench::bench {

/// A table of options, as load_scene() takes them.
struct NamedOptions {
  std::string name;
  std::filesystem::path file;         ///< a scene to begin from; empty: the defaults
  std::vector<std::string> settings;  ///< section.key=value
};

/// Throws UserError "SOURCE: KEY: ALLOWED".
[[noreturn]] void refuse_plan(const std::string& source,
                              const std::string& key,
                              const std::string& allowed);

/// Refuses the first of `given`, the keys of a plan, that is not one of `known`.
void refuse_unknown_keys(const std::vector<std::string>& given,
                         const std::vector<std::string>& known,
                         const std::string& source);

/// The tables [KEY.NAME] of a plan, one or more. Where KEY is "settings" they hold [render] alone.
/// Throws UserError.
std::vector<NamedOptions> load_option_tables(const std::filesystem::path& path,
                                             const std::string& key);

/// The table [KEY] of a plan, without settings where the plan has none. Throws UserError.
NamedOptions load_option_table(const std::filesystem::path& path, const std::string& key);

/// Names become parts of files' names. Throws UserError.
void check_option_name(const std::string& source, const std::string& key, const std::string& name);

/// A value without the quotes of TOML's texts.
std::string plain_value(const std::string& value);

}  // namespace wobblebench::bench
