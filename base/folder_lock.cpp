#include "base/folder_lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

namespace wobblebench {

namespace {

/// False if the file was removed, as by a process that had the lock until now.
bool has_name(int file, const char* path) {
  struct stat open {
  }, named{};
  return ::fstat(file, &open) == 0 && ::lstat(path, &named) == 0 && open.st_dev == named.st_dev &&
         open.st_ino == named.st_ino;
}

[[noreturn]] void fail(const std::filesystem::path& path) {
  throw std::system_error(errno, std::generic_category(), path.string());
}

}  // namespace

FolderLock::FolderLock(const std::filesystem::path& folder) : path_(folder / kFileName) {
  do {
    file_ = FileDescriptor(
        ::open(path_.c_str(), O_CREAT | O_RDWR | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK, 0666));
    if (!file_.is_open()) fail(path_);
    if (::flock(file_.get(), LOCK_EX | LOCK_NB) != 0) {
      if (errno == EWOULDBLOCK) throw FolderInUse();
      fail(path_);
    }
  } while (!has_name(file_.get(), path_.c_str()));
}

FolderLock::~FolderLock() {
  // Somebody else may have removed it, and a third made a new one.
  if (has_name(file_.get(), path_.c_str())) ::unlink(path_.c_str());
}

}  // namespace wobblebench
