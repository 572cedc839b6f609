// The one way in which a recording's bytes are read.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>

namespace wobblebench::hw {

/// An open recording: a regular file that begins, damage apart, with a packet that can be read.
/// Not thread-safe.
class RecordingFile {
 public:
  /// Throws LinkOpenError.
  explicit RecordingFile(const std::filesystem::path& path);
  ~RecordingFile();
  RecordingFile(const RecordingFile&) = delete;
  RecordingFile& operator=(const RecordingFile&) = delete;

  /// Bytes from `offset`; fewer than asked only at the end of the file. Throws std::runtime_error
  /// "PATH: cannot be read: reason".
  std::size_t read(std::uint64_t offset, std::span<std::byte> buffer) const;

  std::uint64_t bytes() const { return bytes_; }
  /// Of a buffer to read it with, piece by piece: large enough to be cheap, not larger than it is.
  std::size_t piece_bytes() const { return std::min<std::uint64_t>(bytes_ + 1, 65536); }
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
  int file_ = -1;
  std::uint64_t bytes_ = 0;
};

}  // namespace wobblebench::hw
