#include "hw/emulator/fifo_emulator.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <system_error>

#include "base/file.h"
#include "hw/emulator/fuse_session.h"

namespace wobblebench::hw {
namespace {

/// How often the thread checks for a stop.
constexpr auto kFifoPollInterval = std::chrono::milliseconds(5);

/// So that write(2) gives EPIPE when the reader closes, instead of ending the process.
void block_broken_pipe() {
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGPIPE);
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
}

/// False: unplugged, or the reader has closed.
bool write_all(const FileDescriptor& fifo,
               std::span<const std::byte> bytes,
               const std::stop_token& unplugged) {
  while (!bytes.empty()) {
    if (unplugged.stop_requested()) return false;
    pollfd watched{fifo.get(), POLLOUT, 0};
    ::poll(&watched, 1, static_cast<int>(kFifoPollInterval.count()));
    const ssize_t count = ::write(fifo.get(), bytes.data(), bytes.size());
    if (count > 0) bytes = bytes.subspan(static_cast<std::size_t>(count));
    if (count < 0 && errno != EAGAIN && errno != EINTR) return false;
  }
  return true;
}

}  // namespace

FifoEmulator::FifoEmulator(const std::filesystem::path& folder, std::unique_ptr<Link> source)
    : path_(folder / kNodeName), source_(std::move(source)) {
  if (::mkfifo(path_.c_str(), 0666) != 0) {
    throw std::system_error(errno, std::generic_category(), path_.string());
  }
  thread_ = std::jthread([this](const std::stop_token& unplugged) { feed(unplugged); });
}

FifoEmulator::~FifoEmulator() {
  unplug();
  thread_.join();
  std::error_code ignored;
  std::filesystem::remove(path_, ignored);
}

void FifoEmulator::feed(const std::stop_token& unplugged) {
  block_broken_pipe();
  FileDescriptor fifo;
  while (!fifo.is_open() && !unplugged.stop_requested()) {
    // ENXIO until a reader has opened it.
    fifo = FileDescriptor(::open(path_.c_str(), O_WRONLY | O_NONBLOCK | O_CLOEXEC));
    if (!fifo.is_open()) std::this_thread::sleep_for(kFifoPollInterval);
  }
  std::array<std::byte, 65536> buffer;
  while (!unplugged.stop_requested()) {
    const ReadResult result = source_->read(buffer, HostClock::now() + kFifoPollInterval);
    if (result.status == ReadStatus::timeout) continue;
    if (result.status != ReadStatus::ok) return;
    if (!write_all(fifo, std::span(buffer).first(result.bytes), unplugged)) return;
  }
}

}  // namespace wobblebench::hw
