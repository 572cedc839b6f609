// Writes a recording to disk.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>

#include "base/file.h"

namespace wobblebench::bench {

/// A new file of a recording. Bytes are in the kernel when write() returns, and on the disk when
/// sync() does: after a kill it holds all that was written, after a power failure all that was
/// synced. The destructor removes the file unless finish() or keep() was called.
class RecordingSink {
 public:
  /// Throws UserError where there is a file of that name, be it a link, or none can be made.
  explicit RecordingSink(const std::filesystem::path& path);
  ~RecordingSink();
  RecordingSink(const RecordingSink&) = delete;
  RecordingSink& operator=(const RecordingSink&) = delete;

  /// Each throws std::runtime_error "PATH: cannot be written: reason", say a full disk.
  void write(std::span<const std::byte> bytes);
  void sync();
  /// Cuts the file to its first `bytes`, syncs and closes it.
  void finish(std::uint64_t bytes);
  /// Leaves the file as it is.
  void keep() { kept_ = true; }

  const std::filesystem::path& path() const { return path_; }
  /// Written so far.
  std::uint64_t bytes() const { return bytes_; }

 private:
  [[noreturn]] void refuse(int error_number) const;

  std::filesystem::path path_;
  FileDescriptor file_;
  std::uint64_t bytes_ = 0;
  bool kept_ = false;
};

}  // namespace wobblebench::bench
