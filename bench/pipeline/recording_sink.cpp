#include "bench/pipeline/recording_sink.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <string>

#include "base/file.h"
#include "base/user_error.h"

namespace wobblebench::bench {

RecordingSink::RecordingSink(const std::filesystem::path& path) : path_(path) {
  constexpr int kNew = O_CREAT | O_EXCL | O_NOFOLLOW;
  file_ = FileDescriptor(::open(path.c_str(), kNew | O_WRONLY | O_CLOEXEC, 0666));
  if (!file_.is_open()) {
    throw UserError(path.string() + ": cannot be written: " + std::strerror(errno));
  }
  // Its name survives a power failure, too.
  sync_folder(path.has_parent_path() ? path.parent_path() : ".");
}

RecordingSink::~RecordingSink() {
  if (!kept_) ::unlink(path_.c_str());
}

void RecordingSink::refuse(int error_number) const {
  throw std::runtime_error(path_.string() + ": cannot be written: " + std::strerror(error_number));
}

void RecordingSink::write(std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t count = ::write(file_.get(), bytes.data(), bytes.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) refuse(errno);
    bytes_ += static_cast<std::uint64_t>(count);
    bytes = bytes.subspan(static_cast<std::size_t>(count));
  }
}

void RecordingSink::sync() {
  const int error = sync_data(file_.get());
  if (error != 0) refuse(error);
}

void RecordingSink::finish(std::uint64_t bytes) {
  keep();
  if (::ftruncate(file_.get(), static_cast<off_t>(bytes)) != 0) refuse(errno);
  bytes_ = bytes;
  const int error = sync_file(file_.get());
  const int close_error = file_.close();
  if (error != 0 || close_error != 0) refuse(error != 0 ? error : close_error);
}

}  // namespace wobblebench::bench
