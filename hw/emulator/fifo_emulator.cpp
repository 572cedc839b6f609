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

#include "base/file_descriptor.h"
#include "hw/emulator/fuse_node.h"

namespace wobblebench::hw {
namespace {

/// How often the thread looks whether it has to end.
constexpr auto kGlance = std::chrono::milliseconds(5);

/// A reader that leaves is an error to see, not a signal that ends the process.
void block_broken_pipe() {
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGPIPE);
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
}

}  // namespace

FifoEmulator::FifoEmulator(const std::filesystem::path& folder, std::unique_ptr<Link> source)
    : path_(folder / kNodeName), source_(std::move(source)) {
  if (::mkfifo(path_.c_str(), 0666) != 0) {
    throw std::system_error(errno, std::generic_category(), path_.string());
  }
  thread_ = std::thread([this] { feed(); });
}

FifoEmulator::~FifoEmulator() {
  unplug();
  thread_.join();
  std::error_code ignored;
  std::filesystem::remove(path_, ignored);
}

void FifoEmulator::feed() {
  block_broken_pipe();
  FileDescriptor fifo;
  while (!fifo.is_open() && !unplugged_) {
    // Without a reader it does not open (ENXIO).
    fifo = FileDescriptor(::open(path_.c_str(), O_WRONLY | O_NONBLOCK | O_CLOEXEC));
    if (!fifo.is_open()) std::this_thread::sleep_for(kGlance);
  }
  std::array<std::byte, 65536> buffer;
  while (!unplugged_) {
    const ReadResult result = source_->read(buffer, HostClock::now() + kGlance);
    if (result.status == ReadStatus::timeout) continue;
    if (result.status != ReadStatus::ok) return;
    if (!write(fifo.get(), std::span(buffer).first(result.bytes))) return;
  }
}

bool FifoEmulator::write(int fifo, std::span<const std::byte> bytes) const {
  while (!bytes.empty()) {
    if (unplugged_) return false;
    pollfd watched{fifo, POLLOUT, 0};
    ::poll(&watched, 1, static_cast<int>(kGlance.count()));
    const ssize_t count = ::write(fifo, bytes.data(), bytes.size());
    if (count > 0) bytes = bytes.subspan(static_cast<std::size_t>(count));
    if (count < 0 && errno != EAGAIN && errno != EINTR) return false;
  }
  return true;
}

}  // namespace wobblebench::hw
