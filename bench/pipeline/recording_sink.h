// A recording on its way to disk.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>

#include "base/file_descriptor.h"

namespace wobblebench::bench {

/// Writes PATH.partial, and gives it its name in finish(). Bytes are with the kernel when write()
/// returns, and on the disk when sync() does: a program that is killed leaves PATH.partial with all
/// that was written, a machine that loses its power what was synced. Never deleted: what was
/// recorded cannot be recorded again.
class RecordingSink {
 public:
  /// Throws UserError where the file cannot be made.
  explicit RecordingSink(const std::filesystem::path& path);

  /// Each throws std::runtime_error "PATH: cannot be written: reason"; a disk is full, say.
  void write(std::span<const std::byte> bytes);
  void sync();
  void finish();

  const std::filesystem::path& path() const { return path_; }
  const std::filesystem::path& partial() const { return partial_; }

 private:
  [[noreturn]] void refuse(int error_number) const;

  std::filesystem::path path_;
  std::filesystem::path partial_;
  FileDescriptor file_;
};

}  // namespace wobblebench::bench
