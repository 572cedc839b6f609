// Any file as a recording: inspected, salvaged, inspected again, played by acquisition and in a
// loop.
#include <sys/mman.h>
#include <unistd.h>

#include <cstdint>
#include <cstdlib>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "base/file.h"
#include "base/options.h"
#include "hw/board/board.h"
#include "hw/recording/file_link.h"
#include "hw/recording/recording.h"
#include "hw/wire/stream_audit.h"
#include "tests/fuzz/reseal.h"

namespace hw = wobblebench::hw;

namespace {

/// A file in memory, with a path. Rewritten for each input: to create and remove one takes longer
/// than to read it, hence the static objects below.
class MemoryFile {
 public:
  MemoryFile() : file_(::memfd_create("fuzz", 0)) {}

  /// Its path, holding these bytes.
  std::string holding(const void* data, std::size_t size) {
    const bool written = ::ftruncate(file_.get(), 0) == 0 &&
                         ::pwrite(file_.get(), data, size, 0) == static_cast<ssize_t>(size);
    if (!written) std::abort();
    return "/proc/self/fd/" + std::to_string(file_.get());
  }

 private:
  wobblebench::FileDescriptor file_;
};

void salvage(const std::string& path, const hw::RecordingContents& contents) {
  std::vector<std::byte> kept;
  try {
    hw::salvage_recording(path,
                          [&](auto bytes) { kept.insert(kept.end(), bytes.begin(), bytes.end()); });
  } catch (const std::runtime_error&) {
    return;  // no configuration
  }
  if (kept.empty()) return;
  static MemoryFile file;
  const hw::RecordingContents again = hw::inspect_recording(file.holding(kept.data(), kept.size()));
  if (again.damaged() || again.unconfigured > 0) std::abort();
  // Of two equal acquisitions that come together because what lay between them is lost, the second
  // is not told from repeated packets where the first has few sticks.
  const std::uint64_t hidden = hw::kMostLateSticks * contents.acquisition_count;
  const bool is_one = contents.acquisition_count <= 1;
  if (again.account.delivered + (is_one ? 0 : hidden) < contents.account.delivered) std::abort();
}

/// Each acquisition alone has the sticks that it has in the whole.
void play_acquisitions(const std::string& path, const hw::RecordingContents& contents) {
  for (std::size_t i = 0; i < contents.acquisitions.size() && i < 4; ++i) {
    hw::FileLinkOptions options;
    options.acquisition = static_cast<int>(i) + 1;
    hw::Board board(std::make_unique<hw::FileLink>(path, options), {.ring_slots = 8});
    board.start();
    std::uint64_t sticks = 0;
    for (;;) {
      const hw::Event event = board.next(hw::HostTime::max());
      if (std::holds_alternative<hw::StickSlot>(event)) ++sticks;
      if (std::holds_alternative<hw::EndOfStream>(event)) break;
      if (std::holds_alternative<hw::DeviceLost>(event)) break;
    }
    if (sticks != contents.acquisitions[i].sticks) std::abort();
  }
}

void loop(const std::string& path) {
  try {
    hw::FileLink link(path, {.loop = true});
    std::vector<std::byte> buffer(4096);
    for (int i = 0; i < 20; ++i) link.read(buffer, hw::HostTime::min());
  } catch (const wobblebench::InvalidOption&) {
    // A loop that cannot continue.
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static MemoryFile file;
  const std::string path = file.holding(data, size);
  try {
    const hw::RecordingContents contents = hw::inspect_recording(path);
    if (!contents.account.balanced()) std::abort();
    salvage(path, contents);
    play_acquisitions(path, contents);
    loop(path);
  } catch (const hw::LinkOpenError&) {
    // No recording.
  }
  return 0;
}

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data,
                                               std::size_t size,
                                               std::size_t max_size,
                                               unsigned seed) {
  return wobblebench::fuzz::mutate_and_seal(data, size, max_size, seed);
}
