#include "bench/cache/blob_cache.h"

#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <fstream>
#include <stdexcept>
#include <system_error>
#include <vector>

#include "base/file.h"
#include "bench/cache/sha256.h"

namespace wobblebench::bench {

namespace {

namespace fs = std::filesystem;

/// Of an entry, in hexadecimal.
std::string digest(std::string_view key, std::string_view bytes) {
  Sha256 hash;
  hash.add(std::to_string(key.size()));
  hash.add(key);
  hash.add(bytes);
  return hex(hash.digest());
}

const std::size_t kDigestSize = 2 * Sha256::Digest().size();

bool write(const fs::path& path, std::string_view key, std::string_view bytes) {
  std::ofstream file(path, std::ios::binary);
  file << bytes << digest(key, bytes);
  file.close();
  return file.good();
}

}  // namespace

fs::path BlobCache::path_of(std::string_view key) const {
  return folder_ / (digest(key, "").substr(0, 32) + ".blob");
}

std::optional<std::string> BlobCache::load(std::string_view key) const {
  const fs::path path = path_of(key);
  try {
    std::string bytes = read_file(path);
    if (bytes.size() < kDigestSize) return std::nullopt;
    const std::string kept = bytes.substr(bytes.size() - kDigestSize);
    bytes.resize(bytes.size() - kDigestSize);
    if (kept != digest(key, bytes)) return std::nullopt;
    std::error_code ignored;
    fs::last_write_time(path, fs::file_time_type::clock::now(), ignored);
    return bytes;
  } catch (const std::runtime_error&) {
    return std::nullopt;
  }
}

bool BlobCache::store(std::string_view key, std::string_view bytes) const {
  static std::atomic<unsigned> number = 0;
  if (bytes.size() + kDigestSize > most_bytes_) return false;
  std::error_code error;
  fs::create_directories(folder_.parent_path(), error);
  if (::mkdir(folder_.c_str(), 0700) != 0 && errno != EEXIST) return false;
  const fs::path path = path_of(key);
  const fs::path partial =
      path.string() + "." + std::to_string(::getpid()) + "-" + std::to_string(number++);
  error.clear();
  if (write(partial, key, bytes)) {
    fs::rename(partial, path, error);
    if (!error) keep_bound();
    if (!error) return true;
  }
  fs::remove(partial, error);
  return false;
}

void BlobCache::keep_bound() const {
  struct Entry {
    fs::file_time_type used;
    std::uint64_t size;
    fs::path path;
  };
  std::vector<Entry> entries;
  std::uint64_t all = 0;
  std::error_code error;
  for (fs::directory_iterator at(folder_, error), last; !error && at != last; at.increment(error)) {
    std::error_code gone;  // another process removed it
    const Entry entry{at->last_write_time(gone), at->file_size(gone), at->path()};
    if (gone || !at->is_regular_file(gone)) continue;
    all += entry.size;
    entries.push_back(entry);
  }
  std::ranges::sort(entries, {}, &Entry::used);
  for (const Entry& entry : entries) {
    if (all <= most_bytes_) return;
    if (fs::remove(entry.path, error)) all -= entry.size;
  }
}

std::optional<fs::path> default_cache_folder() {
  const auto home = cache_home();
  return home ? std::optional(*home / "wobblebench") : std::nullopt;
}

}  // namespace wobblebench::bench
