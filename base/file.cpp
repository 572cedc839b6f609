#include "base/file.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <stdexcept>
#include <string>
#include <system_error>

namespace wobblebench {

namespace {

/// errno, unless it says that there is no disk to wait for.
int failure(int result) {
  return result == 0 || errno == EINVAL || errno == ENOTSUP ? 0 : errno;
}

void sync_path(const std::filesystem::path& path, int flags) {
  const FileDescriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC | flags));
  const int error = file.is_open() ? sync_file(file.get()) : errno;
  if (error == 0) return;
  throw std::runtime_error(path.string() + ": cannot be written: " + std::strerror(error));
}

/// False if the file was removed, as by a process that had the lock until now.
bool has_name(int file, const char* path) {
  struct stat open {
  }, named{};
  return ::fstat(file, &open) == 0 && ::lstat(path, &named) == 0 && open.st_dev == named.st_dev &&
         open.st_ino == named.st_ino;
}

[[noreturn]] void fail(const std::filesystem::path& path) {
  throw std::system_error(errno, std::generic_category(), path.string());
}

[[noreturn]] void refuse_reading(const std::filesystem::path& path, const std::string& reason) {
  throw std::runtime_error(path.string() + ": cannot be read: " + reason);
}

/// Does not wait for the writer of a FIFO.
FileDescriptor open_to_read(const std::filesystem::path& path) {
  FileDescriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
  struct stat status {};
  if (!file.is_open() || ::fstat(file.get(), &status) != 0) {
    refuse_reading(path, std::strerror(errno));
  }
  if (S_ISDIR(status.st_mode)) refuse_reading(path, "is a folder");
  if (!S_ISREG(status.st_mode)) refuse_reading(path, "is no file");
  return file;
}

/// Calls body(piece) until the end of the file, or until it returns false.
template <class Body>
void read_while(const FileDescriptor& file, const std::filesystem::path& path, const Body& body) {
  std::array<char, 1 << 16> bytes{};
  for (;;) {
    const ssize_t count = ::read(file.get(), bytes.data(), bytes.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) refuse_reading(path, std::strerror(errno));
    if (count == 0 || !body(std::string_view(bytes.data(), static_cast<std::size_t>(count))))
      return;
  }
}

}  // namespace

void read_pieces(const std::filesystem::path& path,
                 const std::function<void(std::string_view)>& body) {
  read_while(open_to_read(path), path, [&](std::string_view piece) {
    body(piece);
    return true;
  });
}

std::string read_file(const std::filesystem::path& path, std::size_t most) {
  return read_file(open_to_read(path), path, most);
}

std::string read_file(const FileDescriptor& file,
                      const std::filesystem::path& path,
                      std::size_t most) {
  std::string text;
  struct stat status {};
  if (::fstat(file.get(), &status) == 0) {
    text.reserve(std::min(most, static_cast<std::size_t>(status.st_size)));
  }
  read_while(file, path, [&](std::string_view piece) {
    text += piece.substr(0, most - text.size());
    return text.size() < most;
  });
  return text;
}

void write_file(const std::filesystem::path& path, std::string_view bytes) {
  const auto refuse = [&](int reason) {
    throw std::runtime_error(path.string() + ": cannot be written: " + std::strerror(reason));
  };
  FileDescriptor file(::open(path.c_str(), O_CREAT | O_TRUNC | O_WRONLY | O_CLOEXEC, 0666));
  if (!file.is_open()) refuse(errno);
  const int write_error = write_all(file.get(), bytes) ? sync_file(file.get()) : errno;
  const int close_error = file.close();
  if (write_error == 0 && close_error == 0) return;
  std::error_code ignored;
  if (std::filesystem::is_regular_file(path, ignored)) std::filesystem::remove(path, ignored);
  refuse(write_error != 0 ? write_error : close_error);
}

bool write_all(int descriptor, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t count = ::write(descriptor, bytes.data(), bytes.size());
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return false;
    bytes.remove_prefix(static_cast<std::size_t>(count));
  }
  return true;
}

int sync_file(int descriptor) {
  return failure(::fsync(descriptor));
}

int sync_data(int descriptor) {
  return failure(::fdatasync(descriptor));
}

void sync_file(const std::filesystem::path& path) {
  sync_path(path, O_NOFOLLOW);
}

void sync_folder(const std::filesystem::path& path) {
  sync_path(path, O_DIRECTORY);
}

std::optional<std::filesystem::path> cache_home() {
  for (const auto& [variable, below] : {std::pair{"XDG_CACHE_HOME", ""}, {"HOME", ".cache"}}) {
    const char* value = std::getenv(variable);
    if (value != nullptr && value[0] == '/') return std::filesystem::path(value) / below;
  }
  return std::nullopt;
}

FolderLock::FolderLock(const std::filesystem::path& folder) : path_(folder / kFileName) {
  do {
    file_ = FileDescriptor(
        ::open(path_.c_str(), O_CREAT | O_RDWR | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK, 0666));
    if (!file_.is_open()) fail(path_);
    if (::flock(file_.get(), LOCK_EX | LOCK_NB) != 0) {
      if (errno == EWOULDBLOCK) throw FolderInUse();
      const bool has_no_locks = errno == ENOLCK || errno == EOPNOTSUPP || errno == ENOSYS;
      if (!has_no_locks) fail(path_);
      keeps_others_out_ = false;
    }
  } while (!has_name(file_.get(), path_.c_str()));
}

FolderLock::~FolderLock() {
  // Somebody else may have removed it, and a third made a new one.
  if (has_name(file_.get(), path_.c_str())) ::unlink(path_.c_str());
}

void occupy_standard_descriptors() {
  for (const int number : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (::fcntl(number, F_GETFD) >= 0) continue;
    // The wrong way round, so that use of the stream is an error, as it is when it is closed.
    const int flags = number == STDIN_FILENO ? O_WRONLY : O_RDONLY;
    // The lowest free number is this one, as those below are open.
    if (::open("/dev/null", flags) != number) {
      throw std::system_error(errno, std::generic_category(), "/dev/null");
    }
  }
}

void write_new_file(const std::filesystem::path& path, std::string_view bytes, int folder) {
  const int from = folder < 0 ? AT_FDCWD : folder;
  const std::filesystem::path name = folder < 0 ? path : path.filename();
  const auto refuse = [&](int reason) {
    throw std::runtime_error(path.string() + ": cannot be written: " + std::strerror(reason));
  };
  constexpr int kNew = O_CREAT | O_EXCL | O_NOFOLLOW;
  FileDescriptor file(::openat(from, name.c_str(), kNew | O_WRONLY | O_CLOEXEC, 0666));
  if (!file.is_open()) refuse(errno);
  const int write_error = write_all(file.get(), bytes) ? sync_file(file.get()) : errno;
  const int close_error = file.close();
  if (write_error == 0 && close_error == 0) return;
  ::unlinkat(from, name.c_str(), 0);
  refuse(write_error != 0 ? write_error : close_error);
}

}  // namespace wobblebench
