#include "base/new_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <string>

#include "base/file.h"

namespace wobblebench {

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
