// Writes a recording to disk.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>

#include "base/file_descriptor.h"

namespace wobblebench::bench {

/// Writes PATH.partial, which finish() renames to PATH. Bytes are in the kernel when write()
/// returns, and on the disk when sync() does: after a kill PATH.partial holds all that was written,
/// after a power failure all that was synced. Deleted only by discard(): a recording cannot be
/// repeated.
class RecordingSink {
 public:
  /// Throws UserError where the file cannot be created.
  explicit RecordingSink(const std::filesystem::path& path);

  /// Each throws std::runtime_error "PATH: cannot be written: reason", say a full disk.
  void write(std::span<const std::byte> bytes);
  void sync();
  void finish();
  /// Removes the partial file, which holds no packet.
  void discard();

  const std::filesystem::path& path() const { return path_; }
  const std::filesystem::path& partial() const { return partial_; }

 private:
  [[noreturn]] void refuse(int error_number) const;

  std::filesystem::path path_;
  std::filesystem::path partial_;
  FileDescriptor file_;
};

}  // namespace wobblebench::bench
