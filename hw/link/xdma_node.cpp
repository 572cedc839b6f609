#include "hw/link/xdma_node.h"

#include <fcntl.h>
#include <linux/magic.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <sys/vfs.h>

#include <bit>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <system_error>
#include <thread>

#include "hw/link/link.h"

namespace wobblebench::hw {
namespace {

/// The driver's ioctl for the alignment of its engine (cdev_sgdma.h).
constexpr unsigned long kAlignGet = _IOR('q', 6, int);

/// The kernel requires write permission for O_TRUNC.
const char* allowed(OpenFault fault, bool end_of_packet) {
  switch (fault) {
    case OpenFault::not_permitted:
      return end_of_packet ? "must be readable and, for end_of_packet, writable by this user"
                           : "must be readable by this user";
    case OpenFault::busy:
      return "has one reader at a time";
    case OpenFault::gone:
      return "must be a card that answers";
    default:
      return "must be a character device or a FIFO; a recording is opened with file=";
  }
}

[[noreturn]] void refuse(const std::filesystem::path& path,
                         OpenFault fault,
                         const std::string& wrong,
                         bool end_of_packet = false) {
  throw LinkOpenError(fault, path.string() + ": " + wrong + "; " + allowed(fault, end_of_packet));
}

OpenFault fault_of(int error_number) {
  switch (error_number) {
    case ENOENT:
    case ENOTDIR:
    case ELOOP:
    case ENAMETOOLONG:
      return OpenFault::missing;
    case EACCES:
    case EPERM:
      return OpenFault::not_permitted;
    case EBUSY:
      return OpenFault::busy;
    default:
      return OpenFault::gone;
  }
}

/// Tells the emulator's node from a recording on a disk.
bool is_on_fuse(const FileDescriptor& file) {
  struct statfs system {};
  return ::fstatfs(file.get(), &system) == 0 && system.f_type == FUSE_SUPER_MAGIC;
}

XdmaNodeKind kind_of(const std::filesystem::path& path, const FileDescriptor& node) {
  struct stat status {};
  if (::fstat(node.get(), &status) != 0) refuse(path, fault_of(errno), error_text(errno));
  if (S_ISCHR(status.st_mode)) return XdmaNodeKind::card;
  if (S_ISFIFO(status.st_mode)) return XdmaNodeKind::fifo;
  if (S_ISREG(status.st_mode) && is_on_fuse(node)) return XdmaNodeKind::emulator;
  const char* wrong = S_ISREG(status.st_mode)   ? "is a regular file"
                      : S_ISDIR(status.st_mode) ? "is a folder"
                      : S_ISBLK(status.st_mode) ? "is a block device"
                                                : "is a socket";
  refuse(path, OpenFault::wrong_kind, wrong);
}

/// Opens the file that was checked, even if the path now names another: O_TRUNC would empty a
/// recording. Non-blocking, as a terminal without a carrier would block here.
FileDescriptor reopen(const FileDescriptor& checked, bool end_of_packet) {
  const std::string path = "/proc/self/fd/" + std::to_string(checked.get());
  const int flags = O_RDONLY | O_CLOEXEC | O_NOCTTY | O_NONBLOCK | (end_of_packet ? O_TRUNC : 0);
  return FileDescriptor(::open(path.c_str(), flags));
}

FileDescriptor reopen_until(const std::filesystem::path& path,
                            const FileDescriptor& checked,
                            bool end_of_packet,
                            HostTime busy_until) {
  for (;;) {
    FileDescriptor file = reopen(checked, end_of_packet);
    if (file.is_open()) return file;
    const int error_number = errno;
    if (error_number == EINTR) continue;
    const bool may_pass = error_number == EBUSY || is_to_be_repeated(error_number);
    if (!may_pass || HostClock::now() >= busy_until) {
      refuse(path, fault_of(error_number), error_text(error_number), end_of_packet);
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
}

std::size_t alignment_of(const FileDescriptor& file) {
  int alignment = 0;
  const bool answered = ::ioctl(file.get(), kAlignGet, &alignment) == 0;
  const bool possible = alignment > 0 && std::has_single_bit(static_cast<unsigned>(alignment));
  return answered && possible ? static_cast<std::size_t>(alignment) : kPageBytes;
}

}  // namespace

bool is_to_be_repeated(int error_number) {
  // Of linux/errno.h, which no program may include.
  constexpr int kRestartSys = 512, kRestartNoIntr = 513, kRestartNoHand = 514, kRestartBlock = 516;
  switch (error_number) {
    case EINTR:
    case ETIMEDOUT:
    case kRestartSys:
    case kRestartNoIntr:
    case kRestartNoHand:
    case kRestartBlock:
      return true;
    default:
      return false;
  }
}

std::string error_text(int error_number) {
  const char* name = ::strerrorname_np(error_number);
  return std::generic_category().message(error_number) + " (" +
         (name != nullptr ? name : std::to_string(error_number)) + ")";
}

XdmaNode open_xdma_node(const std::filesystem::path& path,
                        bool end_of_packet,
                        HostTime busy_until) {
  const FileDescriptor checked(::open(path.c_str(), O_PATH | O_CLOEXEC));
  if (!checked.is_open()) refuse(path, fault_of(errno), error_text(errno));
  XdmaNode node;
  node.kind = kind_of(path, checked);
  const bool fifo = node.kind == XdmaNodeKind::fifo;
  node.file = reopen_until(path, checked, end_of_packet && !fifo, busy_until);
  if (fifo) return node;
  ::fcntl(node.file.get(), F_SETFL, ::fcntl(node.file.get(), F_GETFL) & ~O_NONBLOCK);
  node.alignment = alignment_of(node.file);
  return node;
}

}  // namespace wobblebench::hw
