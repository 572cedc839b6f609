#include "base/write_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <string>

namespace wobblebench {

namespace {

bool write_all(int file, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t count = ::write(file, bytes.data(), bytes.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return false;
    bytes.remove_prefix(static_cast<std::size_t>(count));
  }
  return true;
}

/// What is no file on a disk, /dev/null say, answers EINVAL.
bool reached_disk(int file) {
  return ::fsync(file) == 0 || errno == EINVAL || errno == ENOTSUP;
}

}  // namespace

void write_file(const std::filesystem::path& path, std::string_view bytes) {
  const auto refuse = [&](int reason) {
    throw std::runtime_error(path.string() + ": cannot be written: " + std::strerror(reason));
  };
  const int file = ::open(path.c_str(), O_CREAT | O_TRUNC | O_WRONLY | O_CLOEXEC, 0666);
  if (file < 0) refuse(errno);
  const int failure = write_all(file, bytes) && reached_disk(file) ? 0 : errno;
  const int closing = ::close(file) == 0 ? 0 : errno;
  if (failure != 0 || closing != 0) refuse(failure != 0 ? failure : closing);
}

}  // namespace wobblebench
