#include "bench/studies/rungs/rung_memory.h"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <exception>
#include <stdexcept>

#include "base/file_descriptor.h"
#include "base/user_error.h"
#include "bench/scene/scene.h"

namespace wobblebench::bench {

namespace {

constexpr int kFailed = 1;
constexpr int kRefused = 2;  ///< what the user gave

/// What was measured says why it failed through a pipe, and the caller says it to the user.
struct Pipe {
  FileDescriptor read;
  FileDescriptor write;
};

Pipe open_pipe() {
  std::array<int, 2> ends{};
  if (::pipe2(ends.data(), O_CLOEXEC) != 0) {
    throw std::runtime_error(std::string("pipe: ") + std::strerror(errno));
  }
  return {FileDescriptor(ends[0]), FileDescriptor(ends[1])};
}

[[noreturn]] void run_and_exit(const std::function<void()>& body, int message_to) {
  // A signal ends the fork without clean-up, which is the parent's task.
  std::signal(SIGINT, SIG_DFL);
  std::signal(SIGTERM, SIG_DFL);
  std::signal(SIGHUP, SIG_DFL);
  const auto fail = [&](const std::exception& error, int code) {
    // The exit code says that it failed, even where the reason is lost.
    static_cast<void>(!::write(message_to, error.what(), std::strlen(error.what())));
    ::_exit(code);
  };
  try {
    with_late_refusals(body);
  } catch (const UserError& error) {
    fail(error, kRefused);
  } catch (const std::exception& error) {
    fail(error, kFailed);
  }
  ::_exit(0);
}

std::string read_all(int descriptor) {
  std::string text;
  std::array<char, 4096> piece;
  for (;;) {
    const ssize_t count = ::read(descriptor, piece.data(), piece.size());
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return text;
    text.append(piece.data(), static_cast<std::size_t>(count));
  }
}

}  // namespace

double peak_memory_bytes(const std::function<void()>& body) {
  Pipe message = open_pipe();
  const pid_t child = ::fork();
  if (child < 0) throw std::runtime_error(std::string("fork: ") + std::strerror(errno));
  if (child == 0) run_and_exit(body, message.write.get());
  message.write.close();
  const std::string reason = read_all(message.read.get());
  int status = 0;
  rusage usage{};
  while (::wait4(child, &status, 0, &usage) < 0) {
    if (errno != EINTR) throw std::runtime_error(std::string("wait4: ") + std::strerror(errno));
  }
  if (WIFSIGNALED(status)) {
    throw std::runtime_error("memory: the process that was measured was ended by signal " +
                             std::to_string(WTERMSIG(status)));
  }
  if (WEXITSTATUS(status) == kRefused) throw UserError(reason);
  if (WEXITSTATUS(status) != 0) throw std::runtime_error("memory: " + reason);
  return 1024.0 * static_cast<double>(usage.ru_maxrss);  // Linux counts kilobytes
}

}  // namespace wobblebench::bench
