// An owning handle of a POSIX file descriptor.
#pragma once

#include <unistd.h>

#include <cerrno>
#include <utility>

namespace wobblebench {

/// Closes its descriptor when destroyed. Movable; a negative number means none. Not thread-safe.
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

}  // namespace wobblebench
