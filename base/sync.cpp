#include "base/sync.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <stdexcept>

#include "base/file.h"

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

}  // namespace

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

}  // namespace wobblebench
