// Memory that this process may take.
#pragma once

#include <filesystem>

namespace wobblebench::bench {

/// The machine's physical memory, or the limit of the process's control group where that is less
/// (cgroup v1 and v2, and those above it). `root`: of the file system, for tests.
double available_memory_bytes(const std::filesystem::path& root = "/");

}  // namespace wobblebench::bench
