// Runs a program as a user would, and sees what they would see.
#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace wobblebench::testing_support {

struct ProcessResult {
  int exit_code = -1;  ///< 128 + N when a signal N ended it
  std::string out;
  std::string err;
};

struct ProcessLimits {
  /// After this time `signal` is sent.
  std::optional<std::chrono::milliseconds> interrupt_after;
  /// Or as soon as this holds.
  std::function<bool()> interrupt_when;
  int signal = 2;  // SIGINT
  /// No file may grow beyond this; writing more fails, as on a full disk.
  std::optional<long> file_bytes;
  /// Added to the environment.
  std::vector<std::pair<std::string, std::string>> environment = {};
  /// Standard streams (0, 1, 2) that the program starts without.
  std::vector<int> closed = {};
  /// $XDG_CACHE_HOME; none: a folder that all programs of this process share, so that they make a
  /// phantom once.
  std::optional<std::filesystem::path> cache_home = {};
  /// Neither it nor $HOME names a folder: nothing is kept.
  bool no_cache = false;
};

/// Starts `program` with `arguments` in the folder `directory`, and waits for its end.
ProcessResult run_process(const std::filesystem::path& program,
                          const std::vector<std::string>& arguments,
                          const std::filesystem::path& directory,
                          const ProcessLimits& limits = {});

/// A fresh folder of this test's own, removed with all that is in it by the process that made it.
class ScratchFolder {
 public:
  ScratchFolder();
  ~ScratchFolder();
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }
  /// Names of the files in a folder under it, hidden ones too, sorted.
  std::vector<std::string> files(const std::string& folder = "") const;
  std::filesystem::path write(const std::string& name, const std::string& text) const;

 private:
  std::filesystem::path path_;
  int maker_;  ///< a process; its forks may exit while it is in use
};

}  // namespace wobblebench::testing_support
