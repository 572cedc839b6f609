#include "bench/cache/watched_files.h"

#include <system_error>
#include <utility>

#include "base/user_error.h"
#include "bench/cache/sha256.h"

namespace wobblebench::bench {

namespace fs = std::filesystem;

std::vector<fs::path> phantom_files(const Scene& scene) {
  std::vector<fs::path> files;
  for (const fs::path file : {scene.phantom.file, scene.phantom.scatterers}) {
    std::error_code ignored;
    if (fs::is_regular_file(file, ignored)) files.push_back(file);
  }
  return files;
}

WatchedFiles::WatchedFiles(std::vector<fs::path> files) : files_(std::move(files)), hash_(hash()) {}

void WatchedFiles::refuse_changed(const std::string& source) const {
  if (!changed()) return;
  throw UserError(source +
                  ": a file that it names was changed while it was measured; put it back, or "
                  "measure the new one into another folder");
}

/// Empty where one cannot be read.
std::string WatchedFiles::hash() const {
  std::string text;
  for (const fs::path& file : files_) {
    std::error_code ignored;
    text += fs::is_regular_file(file, ignored) ? sha256_of_file(file) : "none";
  }
  return text;
}

}  // namespace wobblebench::bench
