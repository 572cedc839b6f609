#include "bench/cache/blob_cache.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <system_error>
#include <vector>

#include "base/file.h"
#include "bench/cache/sha256.h"

namespace wobblebench::bench {

namespace {

namespace fs = std::filesystem;

constexpr std::string_view kEntry = ".blob", kPartial = ".partial-";

/// The beginning of an entry; the key and the blob follow.
struct Head {
  char magic[8] = {'W', 'B', 'B', 'L', 'O', 'B', '0', '1'};
  std::uint64_t key_size = 0;
  std::uint64_t blob_size = 0;
  Sha256::Digest digest{};  ///< of both sizes, key and blob
};

template <class T>
std::string_view bytes_of(const T& value) {
  return {reinterpret_cast<const char*>(&value), sizeof value};
}

Head head_of(std::string_view key, std::string_view blob) {
  Head head{.key_size = key.size(), .blob_size = blob.size()};
  Sha256 hash;
  for (const auto part : {bytes_of(head.key_size), bytes_of(head.blob_size), key, blob}) {
    hash.add(part);
  }
  head.digest = hash.digest();
  return head;
}

bool read_all(int file, char* to, std::size_t size) {
  while (size > 0) {
    const ssize_t count = ::read(file, to, size);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return false;
    to += count;
    size -= static_cast<std::size_t>(count);
  }
  return true;
}

/// Beyond this process's limit of a file's size writing would end the process.
bool is_allowed(std::uint64_t size) {
  rlimit limit{};
  return ::getrlimit(RLIMIT_FSIZE, &limit) == 0 && size <= limit.rlim_cur;
}

/// For reading; a link is not followed, and a pipe not waited for.
FileDescriptor open_plain(const fs::path& path) {
  return FileDescriptor(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK));
}

/// Held as long as its writer lives, by the kernel.
bool lock(const FileDescriptor& file) {
  return ::flock(file.get(), LOCK_EX | LOCK_NB) == 0;
}

fs::path partial_path(const fs::path& folder) {
  static std::atomic<unsigned> number = 0;
  return folder / (std::string(kPartial) + std::to_string(::getpid()) + "-" +
                   std::to_string(number.fetch_add(1)));
}

/// The files of the folder whose names begin and end so.
std::vector<fs::path> files(const fs::path& folder, std::string_view begin, std::string_view end) {
  std::vector<fs::path> found;
  std::error_code error;
  for (fs::directory_iterator at(folder, error), last; !error && at != last; at.increment(error)) {
    const std::string name = at->path().filename().string();
    if (name.starts_with(begin) && name.ends_with(end)) found.push_back(at->path());
  }
  return found;
}

}  // namespace

fs::path BlobCache::path_of(std::string_view key) const {
  Sha256 hash;
  hash.add(key);
  return folder_ / (hex(hash.digest()).substr(0, 32) + std::string(kEntry));
}

std::optional<BlobCache::Blob> BlobCache::load(std::string_view key) const {
  const FileDescriptor file = open_plain(path_of(key));
  struct stat status {};
  if (!file.is_open() || ::fstat(file.get(), &status) != 0 || !S_ISREG(status.st_mode)) return {};
  const auto size = static_cast<std::uint64_t>(status.st_size);
  Head head;
  if (size < sizeof head + key.size() || size > most_bytes_) return {};
  if (!read_all(file.get(), reinterpret_cast<char*>(&head), sizeof head)) return {};
  if (std::memcmp(head.magic, Head{}.magic, sizeof head.magic) != 0) return {};
  if (head.key_size != key.size() || head.blob_size != size - sizeof head - key.size()) return {};
  Blob blob;
  const std::size_t rest = size - sizeof head;
  blob.file_ = std::make_unique_for_overwrite<char[]>(rest);
  blob.first_ = key.size();
  blob.size_ = rest - key.size();
  if (!read_all(file.get(), blob.file_.get(), rest)) return {};
  if (std::string_view(blob.file_.get(), key.size()) != key) return {};
  if (head_of(key, blob.bytes()).digest != head.digest) return {};
  ::futimens(file.get(), nullptr);
  return blob;
}

bool BlobCache::write(std::string_view key, std::string_view bytes) const {
  const fs::path partial = partial_path(folder_);
  FileDescriptor file(
      ::open(partial.c_str(), O_CREAT | O_EXCL | O_WRONLY | O_CLOEXEC | O_NOFOLLOW, 0600));
  if (!file.is_open()) return false;
  const Head head = head_of(key, bytes);
  static_cast<void>(lock(file));  // without one, as where there are none, nobody removes the file
  const bool whole = write_all(file.get(), bytes_of(head)) && write_all(file.get(), key) &&
                     write_all(file.get(), bytes) &&
                     ::rename(partial.c_str(), path_of(key).c_str()) == 0;
  if (!whole) ::unlink(partial.c_str());
  return whole;
}

bool BlobCache::store(std::string_view key, std::string_view bytes) const {
  const std::uint64_t size = sizeof(Head) + key.size() + bytes.size();
  if (size > most_bytes_ || !is_allowed(size)) return false;
  std::error_code error;
  fs::create_directories(folder_.parent_path(), error);
  if (::mkdir(folder_.c_str(), 0700) != 0 && errno != EEXIST) return false;
  remove_leftovers();
  const bool kept = write(key, bytes);
  if (kept) keep_bound();
  return kept;
}

void BlobCache::remove_leftovers() const {
  for (const fs::path& path : files(folder_, kPartial, "")) {
    const FileDescriptor file = open_plain(path);
    if (file.is_open() && lock(file)) ::unlink(path.c_str());
  }
}

void BlobCache::keep_bound() const {
  struct Entry {
    fs::file_time_type used;
    std::uint64_t size;
    fs::path path;
  };
  std::vector<Entry> entries;
  std::uint64_t all = 0;
  for (const fs::path& path : files(folder_, "", kEntry)) {
    std::error_code error;
    Entry entry{fs::last_write_time(path, error), 0, path};
    if (!error) entry.size = fs::file_size(path, error);
    if (error) continue;  // another process removed it
    all += entry.size;
    entries.push_back(std::move(entry));
  }
  std::ranges::sort(entries, {}, &Entry::used);
  for (const Entry& entry : entries) {
    if (all <= most_bytes_) return;
    if (::unlink(entry.path.c_str()) == 0) all -= entry.size;
  }
}

std::optional<fs::path> default_cache_folder() {
  const auto home = cache_home();
  return home ? std::optional(*home / "wobblebench") : std::nullopt;
}

}  // namespace wobblebench::bench
