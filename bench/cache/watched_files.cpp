#include "bench/cache/watched_files.h"

#include <sys/stat.h>

#include <cstdint>
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

WatchedFiles::WatchedFiles(std::vector<fs::path> files)
    : files_(std::move(files)), stamps_(stamps()), hash_(hash()) {}

bool WatchedFiles::changed() {
  const std::string now = stamps();
  if (now == stamps_) return false;
  if (hash() != hash_) return true;
  stamps_ = now;
  return false;
}

void WatchedFiles::refuse_changed(const std::string& source) {
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

/// Changes whenever a file is written or replaced, and may change where its content does not.
std::string WatchedFiles::stamps() const {
  std::string text;
  for (const fs::path& file : files_) {
    struct stat status {};
    if (::stat(file.c_str(), &status) != 0) status = {};
    for (const std::int64_t part : {static_cast<std::int64_t>(status.st_dev),
                                    static_cast<std::int64_t>(status.st_ino),
                                    static_cast<std::int64_t>(status.st_size),
                                    static_cast<std::int64_t>(status.st_mtim.tv_sec),
                                    static_cast<std::int64_t>(status.st_mtim.tv_nsec),
                                    static_cast<std::int64_t>(status.st_ctim.tv_sec),
                                    static_cast<std::int64_t>(status.st_ctim.tv_nsec)}) {
      text += std::to_string(part) + " ";
    }
  }
  return text;
}

}  // namespace wobblebench::bench
