// A new file that is written piece by piece.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

#include "base/file.h"

namespace wobblebench::bench {

/// Each function throws std::runtime_error "PATH: cannot be written: reason". A file of that name,
/// be it a link, is refused.
class OutFile {
 public:
  explicit OutFile(std::filesystem::path path);

  void write(std::string_view bytes);
  template <class T>
  void write_values(std::span<const T> values) {
    const auto bytes = std::as_bytes(values);
    write({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  }
  /// Replaces bytes that were written.
  void rewrite(std::uint64_t offset, std::string_view bytes);
  /// Writes what is buffered and closes the file.
  void finish();

  std::uint64_t size() const { return size_; }
  const std::filesystem::path& path() const { return path_; }

 private:
  void flush();
  [[noreturn]] void fail(int error_number) const;

  std::filesystem::path path_;
  FileDescriptor file_;
  std::string buffer_;
  std::uint64_t size_ = 0;
};

}  // namespace wobblebench::bench
