// The one way in which a result's bytes come to disk.
#pragma once

#include <filesystem>
#include <string_view>

namespace wobblebench {

/// Writes `bytes` as the whole content of `path` and waits until the disk has them: a full disk may
/// show only then. Throws std::runtime_error "PATH: cannot be written: reason".
void write_file(const std::filesystem::path& path, std::string_view bytes);

}  // namespace wobblebench
