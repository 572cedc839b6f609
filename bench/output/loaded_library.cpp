#include "bench/output/loaded_library.h"

#include <dlfcn.h>

#include <filesystem>
#include <stdexcept>
#include <vector>

#include "base/shared_library.h"

namespace wobblebench::bench {

namespace {

namespace fs = std::filesystem;

/// Paths where the library may lie, the program's own folder first.
std::vector<fs::path> library_paths(const fs::path& name) {
  std::error_code unknown;
  const fs::path program = fs::read_symlink("/proc/self/exe", unknown);
  return {program.parent_path() / name,
          program.parent_path().parent_path() / WOBBLEBENCH_LIBRARIES_LIBDIR / name,
          fs::path(WOBBLEBENCH_LIBRARIES_BUILT) / name,
          fs::path(WOBBLEBENCH_LIBRARIES_INSTALLED) / name};
}

}  // namespace

void* function_of_library(const std::string& name, const char* symbol, const std::string& what) {
  std::string reasons;
  for (const fs::path& path : library_paths("lib" + name + ".so")) {
    std::string reason;
    if (void* const library = load_library(path, &reason)) {
      if (void* const function = ::dlsym(library, symbol)) return function;
      reason = ::dlerror();
    }
    reasons.append(reasons.empty() ? "" : "; ").append(reason);
  }
  throw std::runtime_error(what + ": " + reasons);
}

}  // namespace wobblebench::bench
