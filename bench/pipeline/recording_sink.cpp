#include "bench/pipeline/recording_sink.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <string>

#include "base/user_error.h"

namespace wobblebench::bench {

RecordingSink::RecordingSink(const std::filesystem::path& path)
    : path_(path), partial_(path.string() + ".partial") {
  std::error_code ignored;
  const auto cannot = [&](const std::string& reason) {
    return UserError(path_.string() + ": cannot be written: " + reason);
  };
  if (std::filesystem::is_directory(path_, ignored)) throw cannot("is a folder");
  file_ = FileDescriptor(::open(partial_.c_str(), O_CREAT | O_TRUNC | O_WRONLY | O_CLOEXEC, 0666));
  if (!file_.is_open()) throw cannot(std::strerror(errno));
}

void RecordingSink::refuse(int error_number) const {
  throw std::runtime_error(partial_.string() +
                           ": cannot be written: " + std::strerror(error_number));
}

void RecordingSink::write(std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t count = ::write(file_.get(), bytes.data(), bytes.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) refuse(errno);
    bytes = bytes.subspan(static_cast<std::size_t>(count));
  }
}

void RecordingSink::sync() {
  if (::fdatasync(file_.get()) != 0 && errno != EINVAL && errno != ENOTSUP) refuse(errno);
}

void RecordingSink::finish() {
  sync();
  const int close_error = file_.close();
  if (close_error != 0) refuse(close_error);
  std::error_code error;
  std::filesystem::rename(partial_, path_, error);
  if (error) {
    throw std::runtime_error(path_.string() + ": cannot be written: " + error.message());
  }
}

void RecordingSink::discard() {
  file_.close();
  std::error_code ignored;
  std::filesystem::remove(partial_, ignored);
}

}  // namespace wobblebench::bench
