#include "hw/emulator/fuse_session.h"

#define FUSE_USE_VERSION 35
#include <fcntl.h>
#include <fuse_lowlevel.h>
#include <poll.h>
#include <sys/eventfd.h>

#include <array>
#include <cerrno>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <mutex>
#include <stdexcept>

#include "hw/emulator/fuse_node.h"
#include "hw/emulator/xdma_card.h"

namespace wobblebench::hw {
namespace {

/// One may sit in a read of the node's one opener; the others answer for opening and closing.
constexpr int kThreads = 4;
/// What each thread still answers when the session ends: a reader may ask again and again.
constexpr int kLastAnswers = 64;

/// What libfuse said last. It has one log for the process, which would go to stderr.
class FuseLog {
 public:
  static FuseLog& instance() {
    static FuseLog log;
    return log;
  }
  std::string last() {
    std::lock_guard lock(mutex_);
    return last_;
  }

 private:
  FuseLog() { fuse_set_log_func(&note); }

  static void note(fuse_log_level, const char* format, std::va_list arguments) {
    std::array<char, 512> line{};
    std::vsnprintf(line.data(), line.size(), format, arguments);
    std::string text = line.data();
    while (!text.empty() && text.back() == '\n') text.pop_back();
    FuseLog& log = instance();
    std::lock_guard lock(log.mutex_);
    log.last_ = text;
  }

  std::mutex mutex_;
  std::string last_;
};

fuse_session* new_session(XdmaCard& card) {
  fuse_args arguments{};
  fuse_opt_add_arg(&arguments, "wobblebench");
  fuse_opt_add_arg(&arguments, "-ofsname=wobblebench,subtype=xdma");
  const fuse_lowlevel_ops& operations = fuse_node_operations();
  fuse_session* session = fuse_session_new(&arguments, &operations, sizeof operations, &card);
  fuse_opt_free_args(&arguments);
  return session;
}

void set_not_blocking(int file) {
  ::fcntl(file, F_SETFL, ::fcntl(file, F_GETFL) | O_NONBLOCK);
}

}  // namespace

FuseSession::FuseSession(const std::filesystem::path& folder, XdmaCard& card)
    : stop_(::eventfd(0, EFD_CLOEXEC)) {
  FuseLog& log = FuseLog::instance();
  session_ = new_session(card);
  if (session_ == nullptr || fuse_session_mount(session_, folder.c_str()) != 0) {
    if (session_ != nullptr) fuse_session_destroy(session_);
    throw std::runtime_error(folder.string() + ": cannot mount FUSE here: " + log.last());
  }
  set_not_blocking(fuse_session_fd(session_));
  for (int i = 0; i < kThreads; ++i) threads_.emplace_back([this] { serve(); });
}

FuseSession::~FuseSession() {
  stopping_ = true;
  ::eventfd_write(stop_.get(), 1);
  for (std::thread& thread : threads_) thread.join();
  // With the last file of the connection closed, the kernel itself fails what is still asked.
  fuse_session_unmount(session_);
  fuse_session_destroy(session_);
}

void FuseSession::serve() {
  fuse_buf request{};
  for (int last = kLastAnswers; last > 0; last -= stopping_ ? 1 : 0) {
    const int size = fuse_session_receive_buf(session_, &request);
    if (size > 0) {
      fuse_session_process_buf(session_, &request);
    } else if (size == -EAGAIN || size == -EINTR) {
      pollfd watched[] = {{fuse_session_fd(session_), POLLIN, 0}, {stop_.get(), POLLIN, 0}};
      ::poll(watched, 2, -1);
      if (watched[1].revents != 0 && watched[0].revents == 0) break;
    } else {
      break;  // Somebody unmounted it.
    }
  }
  std::free(request.mem);
}

}  // namespace wobblebench::hw
