// A folder that keeps blobs of bytes between runs.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

namespace wobblebench::bench {

/// Keeps blobs under keys: any text that names all that a blob depends on. An entry is one file,
/// with its key and a SHA-256 of the whole; one that is damaged, or of another key, is as good as
/// none. Several processes may use one folder: an entry is written under a name of its own and
/// renamed, so that readers see all of it or nothing. It is not synced to disk: what a power
/// failure cuts short has the wrong SHA-256. The folder holds at most `most_bytes`; what was not
/// used for the longest time goes first. Nothing throws or reports a folder that is missing, full
/// or not writable: then nothing is found or kept.
class BlobCache {
 public:
  BlobCache(std::filesystem::path folder, std::uint64_t most_bytes)
      : folder_(std::move(folder)), most_bytes_(most_bytes) {}

  class Blob {
   public:
    std::string_view bytes() const { return {file_.get() + first_, size_}; }

   private:
    friend class BlobCache;
    std::unique_ptr<char[]> file_;
    std::size_t first_ = 0;
    std::size_t size_ = 0;
  };

  [[nodiscard]] std::optional<Blob> load(std::string_view key) const;
  /// Returns whether it is kept.
  bool store(std::string_view key, std::string_view bytes) const;

  const std::filesystem::path& folder() const { return folder_; }
  /// Where the entry of a key is, if there is one.
  std::filesystem::path path_of(std::string_view key) const;

 private:
  bool write(std::string_view key, std::string_view bytes) const;
  void remove_leftovers() const;
  void keep_bound() const;

  std::filesystem::path folder_;
  std::uint64_t most_bytes_;
};

/// cache_home()/wobblebench.
std::optional<std::filesystem::path> default_cache_folder();

}  // namespace wobblebench::bench
