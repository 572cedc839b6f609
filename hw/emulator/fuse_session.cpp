#include "hw/emulator/fuse_session.h"

#define FUSE_USE_VERSION 35
#include <fcntl.h>
#include <fuse_lowlevel.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdarg>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <span>
#include <stdexcept>
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

/// Request handlers; may run on any number of threads. The session's user data is an XdmaCard.
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

/// One may block in a read of the node's only opener; the others serve open and close.
constexpr int kThreads = 4;
/// Requests that each thread still serves when the session ends: a reader may repeat its requests
/// without end.
constexpr int kLastRequests = 64;

std::string formatted(const char* format, std::va_list arguments) {
  std::va_list again;
  va_copy(again, arguments);
  const int length = std::vsnprintf(nullptr, 0, format, again);
  va_end(again);
  std::string text(static_cast<std::size_t>(std::max(length, 0)) + 1, '\0');
  std::vsnprintf(text.data(), text.size(), format, arguments);
  text.pop_back();
  return text;
}

/// Keeps the last log message of libfuse on this thread during its lifetime. libfuse has one log
/// function per process, without user data: hence the thread-local pointer. It stays set, so that
/// libfuse does not write to stderr.
class FuseLogCapture {
 public:
  FuseLogCapture() {
    current_ = this;
    fuse_set_log_func(&store);
  }
  ~FuseLogCapture() { current_ = nullptr; }
  FuseLogCapture(const FuseLogCapture&) = delete;
  FuseLogCapture& operator=(const FuseLogCapture&) = delete;

  const std::string& last_message() const { return last_message_; }

 private:
  static void store(fuse_log_level, const char* format, std::va_list arguments) {
    if (current_ == nullptr) return;
    std::string& message = current_->last_message_;
    message = formatted(format, arguments);
    while (!message.empty() && message.back() == '\n') message.pop_back();
  }

  static thread_local FuseLogCapture* current_;
  std::string last_message_;
};

thread_local FuseLogCapture* FuseLogCapture::current_ = nullptr;

const fuse_lowlevel_ops& node_operations() {
  static const fuse_lowlevel_ops operations = make_operations();
  return operations;
}

fuse_session* new_session(XdmaCard& card) {
  fuse_args arguments{};
  fuse_opt_add_arg(&arguments, "wobblebench");
  fuse_opt_add_arg(&arguments, "-ofsname=wobblebench,subtype=xdma");
  const fuse_lowlevel_ops& operations = node_operations();
  fuse_session* session = fuse_session_new(&arguments, &operations, sizeof operations, &card);
  fuse_opt_free_args(&arguments);
  return session;
}

void set_non_blocking(int file) {
  ::fcntl(file, F_SETFL, ::fcntl(file, F_GETFL) | O_NONBLOCK);
}

}  // namespace

FuseSession::FuseSession(const std::filesystem::path& folder, XdmaCard& card)
    : stop_(::eventfd(0, EFD_CLOEXEC)) {
  const FuseLogCapture log;
  session_ = new_session(card);
  if (session_ == nullptr || fuse_session_mount(session_, folder.c_str()) != 0) {
    if (session_ != nullptr) fuse_session_destroy(session_);
    throw std::runtime_error(folder.string() + ": cannot mount FUSE here: " + log.last_message());
  }
  set_non_blocking(fuse_session_fd(session_));
  for (int i = 0; i < kThreads; ++i) threads_.emplace_back([this] { serve(); });
}

FuseSession::~FuseSession() {
  stopping_ = true;
  ::eventfd_write(stop_.get(), 1);
  threads_.clear();  // joins
  // Once the connection is closed, the kernel fails all further requests itself.
  fuse_session_unmount(session_);
  fuse_session_destroy(session_);
}

void FuseSession::serve() {
  fuse_buf request{};
  for (int last = kLastRequests; last > 0; last -= stopping_ ? 1 : 0) {
    const int size = fuse_session_receive_buf(session_, &request);
    if (size > 0) {
      fuse_session_process_buf(session_, &request);
    } else if (size == -EAGAIN || size == -EINTR) {
      pollfd watched[] = {{fuse_session_fd(session_), POLLIN, 0}, {stop_.get(), POLLIN, 0}};
      ::poll(watched, 2, -1);
      if (watched[1].revents != 0 && watched[0].revents == 0) break;
    } else {
      break;  // Unmounted from outside.
    }
  }
  std::free(request.mem);
}

}  // namespace wobblebench::hw
