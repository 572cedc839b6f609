// Files and folders: descriptors, reading, durable writing, locks.
#pragma once

#include <unistd.h>

#include <cerrno>
#include <cstddef>
#include <filesystem>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

namespace wobblebench {

/// Owns a POSIX file descriptor, and closes it when destroyed. Movable; a negative number means
/// none. Not thread-safe.
class FileDescriptor {
 public:
  explicit FileDescriptor(int number = -1) : number_(number) {}
  FileDescriptor(FileDescriptor&& other) noexcept : number_(std::exchange(other.number_, -1)) {}
  FileDescriptor& operator=(FileDescriptor&& other) noexcept {
    std::swap(number_, other.number_);
    return *this;
  }
  ~FileDescriptor() { close(); }

  int get() const { return number_; }
  bool is_open() const { return number_ >= 0; }

  /// Returns 0, or the errno of close(2). Does nothing if not open.
  int close() { return is_open() && ::close(std::exchange(number_, -1)) != 0 ? errno : 0; }

 private:
  int number_;
};

/// Calls body(piece) for one piece of the file's content after the other. The one way to read a
/// whole file: std::ifstream takes a read that fails for the end of the file. Throws
/// std::runtime_error "PATH: cannot be read: reason", also for a folder, a FIFO or a device.
void read_pieces(const std::filesystem::path& path,
                 const std::function<void(std::string_view)>& body);

/// The content of a file, or its first `most` bytes. Throws as read_pieces().
std::string read_file(const std::filesystem::path& path,
                      std::size_t most = std::numeric_limits<std::size_t>::max());
/// The same from where an open file is read on. `path`: its name, for errors.
std::string read_file(const FileDescriptor& file,
                      const std::filesystem::path& path,
                      std::size_t most = std::numeric_limits<std::size_t>::max());

/// write(2) until all of it is written. False, with errno, where it fails.
bool write_all(int descriptor, std::string_view bytes);

/// fsync(2) of an open file, or fdatasync(2). Returns 0 or errno; 0 too for what is on no disk, a
/// pipe or /dev/null.
int sync_file(int descriptor);
int sync_data(int descriptor);

/// Of a file by its name, and of a folder's names: a new or renamed file survives a power failure
/// when its folder is synced too. Each throws std::runtime_error "PATH: cannot be written: reason".
void sync_file(const std::filesystem::path& path);
void sync_folder(const std::filesystem::path& path);

/// Writes `bytes` as the whole content of `path` and waits for fsync(2): a full disk may be
/// reported only then. Throws std::runtime_error "PATH: cannot be written: reason"; of a file that
/// cannot be written whole nothing is left.
void write_file(const std::filesystem::path& path, std::string_view bytes);

/// write_file() to a new file: where there is one of that name, be it a link, it is not written. Of
/// a file that cannot be written whole nothing is left. `folder`: an open descriptor of the path's
/// folder, through which it is reached whatever has that folder's name now; -1: by the path.
void write_new_file(const std::filesystem::path& path, std::string_view bytes, int folder = -1);

/// $XDG_CACHE_HOME, else $HOME/.cache; none where neither variable holds an absolute path, the only
/// kind that the XDG Base Directory Specification allows.
std::optional<std::filesystem::path> cache_home();

/// An exclusive lock on a folder: a hidden file `.wobblebench.lock` in it, locked with flock(2), so
/// that a lock ends with its process however that ends. The file is removed with the lock; one that
/// a dead process left behind is used again. On a file system without flock(2), as some of a
/// network are, it keeps nobody out.
class FolderLock {
 public:
  static constexpr const char* kFileName = ".wobblebench.lock";

  /// Throws FolderInUse if another process, or another lock of this one, holds it, and
  /// std::system_error where the lock file cannot be made or locked.
  explicit FolderLock(const std::filesystem::path& folder);
  ~FolderLock();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

  const std::filesystem::path& file() const { return path_; }
  bool keeps_others_out() const { return keeps_others_out_; }

 private:
  std::filesystem::path path_;
  bool keeps_others_out_ = true;
  FileDescriptor file_;
};

class FolderInUse : public std::exception {
 public:
  const char* what() const noexcept override { return "is in use by another command"; }
};

/// Opens those of the descriptors 0, 1 and 2 that the caller of the program closed, so that no file
/// opened later gets their number, and with it the text that is written to the stream. Reading or
/// writing such a stream fails. To be called first in main(). Throws std::system_error.
void occupy_standard_descriptors();

}  // namespace wobblebench
