// Any file as a recording: inspected, salvaged, inspected again, and played in a loop.
#include <sys/mman.h>
#include <unistd.h>

#include <cstdint>
#include <cstdlib>
#include <string>
#include <vector>

#include "hw/board.h"
#include "hw/file_link.h"
#include "hw/options.h"
#include "hw/recording.h"
#include "reseal.h"

namespace hw = wobblebench::hw;

namespace {

/// A file in memory, with a path.
class MemoryFile {
 public:
  MemoryFile(const void* data, std::size_t size) : file_(::memfd_create("fuzz", 0)) {
    if (file_ < 0 || ::write(file_, data, size) != static_cast<ssize_t>(size)) std::abort();
  }
  ~MemoryFile() { ::close(file_); }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;
  std::string path() const { return "/proc/self/fd/" + std::to_string(file_); }

 private:
  int file_;
};

void salvage(const std::string& path, const hw::RecordingContents& contents) {
  std::vector<std::byte> kept;
  try {
    hw::salvage_recording(path,
                          [&](auto bytes) { kept.insert(kept.end(), bytes.begin(), bytes.end()); });
  } catch (const std::runtime_error&) {
    return;  // no configuration, or one that is not possible
  }
  if (kept.empty()) return;
  const MemoryFile file(kept.data(), kept.size());
  const hw::RecordingContents again = hw::inspect_recording(file.path());
  if (again.damaged() || again.unconfigured > 0) std::abort();
  if (again.account.delivered < contents.account.delivered) std::abort();
}

void loop(const std::string& path) {
  try {
    hw::FileLink link(path, {.loop = true});
    std::vector<std::byte> buffer(4096);
    for (int i = 0; i < 20; ++i) link.read(buffer, hw::HostTime::min());
  } catch (const hw::InvalidOption&) {
    // A loop that cannot go on.
  } catch (const hw::UnsupportedWireVersion&) {
    // Later in the file.
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const MemoryFile file(data, size);
  try {
    const hw::RecordingContents contents = hw::inspect_recording(file.path());
    if (!contents.account.balanced()) std::abort();
    salvage(file.path(), contents);
    loop(file.path());
  } catch (const hw::LinkOpenError&) {
    // No recording.
  } catch (const std::runtime_error&) {
    // A later version, or a configuration that is not possible.
  }
  return 0;
}

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data,
                                               std::size_t size,
                                               std::size_t max_size,
                                               unsigned seed) {
  return wobblebench::fuzz::mutate_and_seal(data, size, max_size, seed);
}
