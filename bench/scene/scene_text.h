// A scene as a file that makes it.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace wobblebench::bench {

/// TOML of the file's keys (empty path: none) with each "section.key=value" of `settings`:
/// load_scene() reads from it the same scene as from both. Throws UserError.
std::string scene_text(const std::filesystem::path& path, const std::vector<std::string>& settings);

}  // namespace wobblebench::bench
