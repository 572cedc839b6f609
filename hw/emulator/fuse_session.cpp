#include "hw/emulator/fuse_session.h"

#define FUSE_USE_VERSION 35
#include <fcntl.h>
#include <fuse_lowlevel.h>
#include <poll.h>
#include <sys/eventfd.h>

#include <algorithm>
#include <cerrno>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <stdexcept>

#include "hw/emulator/fuse_node.h"
#include "hw/emulator/xdma_card.h"

namespace wobblebench::hw {
namespace {

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

fuse_session* new_session(XdmaCard& card) {
  fuse_args arguments{};
  fuse_opt_add_arg(&arguments, "wobblebench");
  fuse_opt_add_arg(&arguments, "-ofsname=wobblebench,subtype=xdma");
  const fuse_lowlevel_ops& operations = fuse_node_operations();
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
