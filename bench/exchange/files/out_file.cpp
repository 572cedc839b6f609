#include "bench/exchange/files/out_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <utility>

namespace wobblebench::bench {

namespace {

constexpr std::size_t kBufferBytes = 1 << 20;

}  // namespace

OutFile::OutFile(std::filesystem::path path)
    : path_(std::move(path)),
      file_(::open(path_.c_str(), O_CREAT | O_EXCL | O_NOFOLLOW | O_WRONLY | O_CLOEXEC, 0666)) {
  if (!file_.is_open()) fail(errno);
}

void OutFile::fail(int error_number) const {
  throw std::runtime_error(path_.string() + ": cannot be written: " + std::strerror(error_number));
}

void OutFile::write(std::string_view bytes) {
  buffer_ += bytes;
  size_ += bytes.size();
  if (buffer_.size() >= kBufferBytes) flush();
}

void OutFile::flush() {
  if (!write_all(file_.get(), buffer_)) fail(errno);
  buffer_.clear();
}

void OutFile::rewrite(std::uint64_t offset, std::string_view bytes) {
  flush();
  while (!bytes.empty()) {
    const ssize_t count =
        ::pwrite(file_.get(), bytes.data(), bytes.size(), static_cast<off_t>(offset));
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) fail(errno);
    offset += static_cast<std::uint64_t>(count);
    bytes.remove_prefix(static_cast<std::size_t>(count));
  }
}

void OutFile::finish() {
  flush();
  if (const int error = file_.close()) fail(error);
}

}  // namespace wobblebench::bench
