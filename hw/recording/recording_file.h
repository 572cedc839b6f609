// Reads the bytes of a recording file.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>

#include "base/file.h"

namespace wobblebench::hw {

/// An open recording: a regular file that starts, apart from damage, with a readable packet. Not
/// thread-safe.
class RecordingFile {
 public:
  /// Throws LinkOpenError.
  explicit RecordingFile(const std::filesystem::path& path);

  /// Reads from `offset`; returns fewer bytes than the buffer has only at the end of the file.
  /// Throws std::runtime_error "PATH: cannot be read: reason".
  std::size_t read(std::uint64_t offset, std::span<std::byte> buffer) const;

  std::uint64_t bytes() const { return bytes_; }
  /// Size of a buffer for sequential reading: 64 KiB, or just above the file's size.
  std::size_t chunk_bytes() const { return std::min<std::uint64_t>(bytes_ + 1, 65536); }
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
  FileDescriptor file_;
  std::uint64_t bytes_ = 0;
};

}  // namespace wobblebench::hw
