// Keeps two programs out of one folder.
#pragma once

#include <filesystem>

#include "base/file.h"

namespace wobblebench {

/// An exclusive lock on a folder: a hidden file `.wobblebench.lock` in it, locked with flock(2), so
/// that a lock ends with its process however that ends. The file is removed with the lock; one that
/// a dead process left behind is used again.
class FolderLock {
 public:
  static constexpr const char* kFileName = ".wobblebench.lock";

  /// Throws FolderInUse if another process, or another lock of this one, holds it, and
  /// std::system_error where the lock file cannot be made or locked.
  explicit FolderLock(const std::filesystem::path& folder);
  ~FolderLock();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

  const std::filesystem::path& file() const { return path_; }

 private:
  std::filesystem::path path_;
  FileDescriptor file_;
};

class FolderInUse : public std::exception {
 public:
  const char* what() const noexcept override { return "is in use by another command"; }
};

}  // namespace wobblebench
