// A TOML file of the user.
#pragma once

#include <toml++/toml.h>

#include <filesystem>
#include <string>

namespace wobblebench::bench {

/// `what` the file should be, "a scene" say, for refusals. Throws UserError "PATH: reason" for what
/// is no file, is too large, nests too deep or is not TOML.
toml::table parse_toml_file(const std::filesystem::path& path, const std::string& what);

/// Why a table that nests too deep is refused.
std::string too_deep_toml();

}  // namespace wobblebench::bench
