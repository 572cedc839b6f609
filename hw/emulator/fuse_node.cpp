#include "hw/emulator/fuse_node.h"

#define FUSE_USE_VERSION 35
#include <fuse_lowlevel.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <exception>
#include <span>
#include <string_view>
#include <vector>

#include "hw/emulator/xdma_card.h"

namespace wobblebench::hw {
namespace {

constexpr fuse_ino_t kFolder = FUSE_ROOT_ID;
constexpr fuse_ino_t kNode = 2;
/// The driver's ioctl for the alignment of its engine (cdev_sgdma.h).
constexpr unsigned kAlignGet = _IOR('q', 6, int);

XdmaCard& card_of(fuse_req_t request) {
  return *static_cast<XdmaCard*>(fuse_req_userdata(request));
}

struct stat status_of(fuse_ino_t inode) {
  struct stat status {};
  status.st_ino = inode;
  status.st_mode = inode == kFolder ? S_IFDIR | 0755 : S_IFREG | 0666;
  status.st_nlink = inode == kFolder ? 2 : 1;
  status.st_uid = getuid();
  status.st_gid = getgid();
  return status;
}

// Timeouts of 0, so that the kernel caches nothing: unplugging the card removes the node.

void look_up(fuse_req_t request, fuse_ino_t parent, const char* name) {
  if (parent != kFolder || std::string_view(name) != kNodeName || !card_of(request).is_plugged()) {
    fuse_reply_err(request, ENOENT);
    return;
  }
  fuse_entry_param entry{};
  entry.ino = kNode;
  entry.attr = status_of(kNode);
  fuse_reply_entry(request, &entry);
}

void get_attributes(fuse_req_t request, fuse_ino_t inode, fuse_file_info*) {
  const struct stat status = status_of(inode);
  fuse_reply_attr(request, &status, 0);
}

void read_folder(fuse_req_t request, fuse_ino_t, std::size_t size, off_t offset, fuse_file_info*) {
  std::vector<char> listing(size);
  std::size_t used = 0;
  const struct stat node = status_of(kNode);
  if (offset == 0 && card_of(request).is_plugged()) {
    used = fuse_add_direntry(request, listing.data(), size, kNodeName, &node, 1);
  }
  fuse_reply_buf(request, listing.data(), used <= size ? used : 0);
}

int open_card(fuse_req_t request, bool end_of_packet, std::uint64_t& handle) {
  try {
    return card_of(request).open(end_of_packet, handle);
  } catch (const std::exception&) {
    return -EIO;  // The source cannot be opened.
  }
}

void open_node(fuse_req_t request, fuse_ino_t inode, fuse_file_info* file) {
  if (inode != kNode || (file->flags & O_ACCMODE) != O_RDONLY) {
    fuse_reply_err(request, EINVAL);
    return;
  }
  const int result = open_card(request, (file->flags & O_TRUNC) != 0, file->fh);
  if (result != 0) {
    fuse_reply_err(request, -result);
    return;
  }
  file->direct_io = 1;
  file->nonseekable = 1;
  // A caller that was interrupted meanwhile will not release what it opened.
  if (fuse_reply_open(request, file) == -ENOENT) card_of(request).release(file->fh);
}

void read_node(fuse_req_t request, fuse_ino_t, std::size_t size, off_t, fuse_file_info* file) {
  std::vector<std::byte> transfer(size);
  const auto interrupted = [request] { return fuse_req_interrupted(request) != 0; };
  const std::ptrdiff_t count = card_of(request).read(file->fh, transfer, interrupted);
  if (count < 0) {
    fuse_reply_err(request, static_cast<int>(-count));
  } else {
    fuse_reply_buf(
        request, reinterpret_cast<const char*>(transfer.data()), static_cast<std::size_t>(count));
  }
}

void control_node(fuse_req_t request,
                  fuse_ino_t,
                  unsigned command,
                  void*,
                  fuse_file_info*,
                  unsigned,
                  const void*,
                  std::size_t,
                  std::size_t) {
  const int alignment = card_of(request).options().alignment_bytes;
  if (command == kAlignGet) {
    fuse_reply_ioctl(request, 0, &alignment, sizeof alignment);
  } else {
    fuse_reply_err(request, ENOTTY);
  }
}

/// flush: close(2) waits for this, but not for the release.
void close_node(fuse_req_t request, fuse_ino_t, fuse_file_info* file) {
  card_of(request).expect_release(file->fh);
  fuse_reply_err(request, 0);
}

void release_node(fuse_req_t request, fuse_ino_t, fuse_file_info* file) {
  card_of(request).release(file->fh);
  fuse_reply_err(request, 0);
}

fuse_lowlevel_ops make_operations() {
  fuse_lowlevel_ops operations{};
  operations.lookup = look_up;
  operations.getattr = get_attributes;
  operations.readdir = read_folder;
  operations.open = open_node;
  operations.read = read_node;
  operations.ioctl = control_node;
  operations.flush = close_node;
  operations.release = release_node;
  return operations;
}

}  // namespace

const fuse_lowlevel_ops& fuse_node_operations() {
  static const fuse_lowlevel_ops operations = make_operations();
  return operations;
}

}  // namespace wobblebench::hw
