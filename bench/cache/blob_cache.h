// A folder that keeps blobs of bytes between runs.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

namespace wobblebench::bench {

/// Keeps blobs under keys: any text that names all that a blob depends on. An entry is one file,
/// the blob and a SHA-256 of it and its key: one that is damaged, cut short, or of another key is
/// as good as none. Several processes may use one folder: an entry is renamed when it is written.
/// The folder holds at most `most_bytes`; what was not used for the longest time goes first, be it
/// the half entry of a process that was killed. Nothing throws or reports a folder that is missing,
/// full or not writable: then nothing is found or kept.
class BlobCache {
 public:
  BlobCache(std::filesystem::path folder, std::uint64_t most_bytes)
      : folder_(std::move(folder)), most_bytes_(most_bytes) {}

  [[nodiscard]] std::optional<std::string> load(std::string_view key) const;
  /// Returns whether it is kept.
  bool store(std::string_view key, std::string_view bytes) const;

  const std::filesystem::path& folder() const { return folder_; }
  /// Where the entry of a key is, if there is one.
  std::filesystem::path path_of(std::string_view key) const;

 private:
  void keep_bound() const;

  std::filesystem::path folder_;
  std::uint64_t most_bytes_;
};

/// cache_home()/wobblebench.
std::optional<std::filesystem::path> default_cache_folder();

}  // namespace wobblebench::bench
