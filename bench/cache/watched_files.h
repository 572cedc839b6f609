// Whether files change while something is measured that was read from them.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "bench/scene/scene.h"

namespace wobblebench::bench {

/// The files that a scene's phantom is read from.
std::vector<std::filesystem::path> phantom_files(const Scene& scene);

/// Files as they were when this was made.
class WatchedFiles {
 public:
  explicit WatchedFiles(std::vector<std::filesystem::path> files = {});

  /// The content of one is another.
  bool changed() const { return hash() != hash_; }
  /// Throws UserError "SOURCE: …" for that: what was read may be of one body or of the other.
  void refuse_changed(const std::string& source) const;

 private:
  std::string hash() const;

  std::vector<std::filesystem::path> files_;
  std::string hash_;
};

}  // namespace wobblebench::bench
