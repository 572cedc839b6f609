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

/// The driver's question for the alignment of its engine, from its interface (cdev_sgdma.h).
constexpr unsigned long kAlignGet = _IOR('q', 6, int);
/// For a driver that does not know the question: a page suits every engine.
constexpr std::size_t kPageBytes = 4096;

/// The kernel's rule: O_TRUNC asks for the right to write too.
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

/// A file system in user space. A recording on a disk is not to be taken for the stand-in.
bool is_on_fuse(int file) {
  struct statfs system {};
  return ::fstatfs(file, &system) == 0 && system.f_type == FUSE_SUPER_MAGIC;
}

XdmaNodeKind kind_of(const std::filesystem::path& path, int place) {
  struct stat status {};
  if (::fstat(place, &status) != 0) refuse(path, fault_of(errno), error_text(errno));
  if (S_ISCHR(status.st_mode)) return XdmaNodeKind::card;
  if (S_ISFIFO(status.st_mode)) return XdmaNodeKind::fifo;
  if (S_ISREG(status.st_mode) && is_on_fuse(place)) return XdmaNodeKind::stand_in;
  const char* wrong = S_ISREG(status.st_mode)   ? "is a regular file"
                      : S_ISDIR(status.st_mode) ? "is a folder"
                      : S_ISBLK(status.st_mode) ? "is a block device"
                                                : "is a socket";
  refuse(path, OpenFault::wrong_kind, wrong);
}

/// Opens what was checked, whatever the path has come to name: O_TRUNC would empty a recording.
/// Not blocking, or a terminal without a carrier would hang here.
int reopen(int place, bool end_of_packet) {
  const std::string path = "/proc/self/fd/" + std::to_string(place);
  const int flags = O_RDONLY | O_CLOEXEC | O_NOCTTY | O_NONBLOCK | (end_of_packet ? O_TRUNC : 0);
  return ::open(path.c_str(), flags);
}

FileDescriptor open_patiently(const std::filesystem::path& path,
                              int place,
                              bool end_of_packet,
                              HostTime busy_until) {
  for (;;) {
    FileDescriptor file(reopen(place, end_of_packet));
    if (file.is_open()) return file;
    const int error_number = errno;
    if (error_number == EINTR) continue;
    if (error_number != EBUSY || HostClock::now() >= busy_until) {
      refuse(path, fault_of(error_number), error_text(error_number), end_of_packet);
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
}

std::size_t alignment_of(int file) {
  int alignment = 0;
  const bool answered = ::ioctl(file, kAlignGet, &alignment) == 0;
  const bool possible = alignment > 0 && std::has_single_bit(static_cast<unsigned>(alignment));
  return answered && possible ? static_cast<std::size_t>(alignment) : kPageBytes;
}

}  // namespace

std::string error_text(int error_number) {
  const char* name = ::strerrorname_np(error_number);
  return std::generic_category().message(error_number) + " (" +
         (name != nullptr ? name : std::to_string(error_number)) + ")";
}

XdmaNode open_xdma_node(const std::filesystem::path& path,
                        bool end_of_packet,
                        HostTime busy_until) {
  const FileDescriptor place(::open(path.c_str(), O_PATH | O_CLOEXEC));
  if (!place.is_open()) refuse(path, fault_of(errno), error_text(errno));
  XdmaNode node;
  node.kind = kind_of(path, place.get());
  const bool fifo = node.kind == XdmaNodeKind::fifo;
  node.file = open_patiently(path, place.get(), end_of_packet && !fifo, busy_until);
  if (fifo) return node;
  ::fcntl(node.file.get(), F_SETFL, ::fcntl(node.file.get(), F_GETFL) & ~O_NONBLOCK);
  node.alignment = alignment_of(node.file.get());
  return node;
}

}  // namespace wobblebench::hw
