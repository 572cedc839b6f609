// Durable writing of a whole file.
#pragma once

#include <filesystem>
#include <string_view>

namespace wobblebench {

/// Writes `bytes` as the whole content of `path` and waits for fsync(2): a full disk may be
/// reported only then. Throws std::runtime_error "PATH: cannot be written: reason".
void write_file(const std::filesystem::path& path, std::string_view bytes);

}  // namespace wobblebench
