#include "base/write_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <string>

#include "base/file.h"
#include "base/sync.h"

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

}  // namespace

void write_file(const std::filesystem::path& path, std::string_view bytes) {
  const auto refuse = [&](int reason) {
    throw std::runtime_error(path.string() + ": cannot be written: " + std::strerror(reason));
  };
  FileDescriptor file(::open(path.c_str(), O_CREAT | O_TRUNC | O_WRONLY | O_CLOEXEC, 0666));
  if (!file.is_open()) refuse(errno);
  const int write_error = write_all(file.get(), bytes) ? sync_file(file.get()) : errno;
  const int close_error = file.close();
  if (write_error != 0 || close_error != 0) refuse(write_error != 0 ? write_error : close_error);
}

}  // namespace wobblebench
