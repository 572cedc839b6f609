// Named tables of options in a plan.
#pragma once

#include <toml++/toml.h>

#include <filesystem>
#include <string>
#include <vector>

#include "bench/studies/accuracy/accuracy_plan.h"

namespace wobblebench::bench {

/// Throws UserError "SOURCE: KEY: ALLOWED".
[[noreturn]] void refuse_plan(const std::string& source,
                              const std::string& key,
                              const std::string& allowed);

/// Names become parts of files' names.
void check_option_name(const std::string& source, const std::string& key, const std::string& name);

/// The tables [KEY.NAME] of the plan in `path`, KEY "scenes" or "settings". Throws UserError.
std::vector<NamedOptions> read_option_tables(toml::table& root,
                                             const std::string& key,
                                             const std::filesystem::path& path);

}  // namespace wobblebench::bench
