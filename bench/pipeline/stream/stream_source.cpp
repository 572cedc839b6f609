#include "bench/pipeline/stream/stream_source.h"

#include <variant>

#include "hw/board/volume_assembly.h"

namespace wobblebench::bench {

hw::Configuration first_configuration(hw::Board& board, const std::string& name) {
  hw::VolumeAssembly assembly(board);
  board.start();
  if (!assembly.wait_for_configuration(hw::HostClock::now() + kVolumeTimeout)) {
    // The board returns its end again at every call.
    throw nothing_came(name, "configuration", ending_of(board.next(hw::HostTime::min())));
  }
  board.stop();
  return *assembly.configuration();
}

std::string ending_of(const hw::Event& event) {
  if (const auto* lost = std::get_if<hw::DeviceLost>(&event)) return lost->reason;
  const auto* end = std::get_if<hw::EndOfStream>(&event);
  if (end == nullptr) return "";
  return end->truncated ? "the stream is cut short" : "the stream is over";
}

NothingCame nothing_came(const std::string& name, const std::string& what, std::string ending) {
  if (ending.empty()) {
    ending = "nothing arrived for " + std::to_string(kVolumeTimeout.count()) + " minutes";
  }
  return NothingCame("--board " + name + ": no " + what + " came; " + ending);
}

}  // namespace wobblebench::bench
