#include "bench/output/encoders.h"

#include <dlfcn.h>

#include <stdexcept>

namespace wobblebench::bench {

namespace {

namespace fs = std::filesystem;

/// Paths where the library may lie, the program's own folder first.
std::vector<fs::path> library_paths() {
  std::error_code unknown;
  const fs::path program = fs::read_symlink("/proc/self/exe", unknown);
  const fs::path name = WOBBLEBENCH_ENCODERS;
  return {program.parent_path() / name,
          program.parent_path().parent_path() / WOBBLEBENCH_ENCODERS_LIBDIR / name,
          fs::path(WOBBLEBENCH_ENCODERS_BUILT) / name,
          fs::path(WOBBLEBENCH_ENCODERS_INSTALLED) / name};
}

const Encoders& load() {
  std::string reasons;
  for (const fs::path& path : library_paths()) {
    void* const library = ::dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
    if (library != nullptr) {
      using Offer = const Encoders*();
      return *reinterpret_cast<Offer*>(::dlsym(library, "wobblebench_encoders"))();
    }
    reasons.append(reasons.empty() ? "" : "; ").append(::dlerror());
  }
  throw std::runtime_error("no encoders of pictures and videos: " + reasons);
}

}  // namespace

const Encoders& encoders() {
  static const Encoders& loaded = load();
  return loaded;
}

}  // namespace wobblebench::bench
