#include "bench/pipeline/whole_volume.h"

#include <utility>
#include <variant>

namespace wobblebench::bench {

namespace {

bool has_first_stick(const hw::PolarVolume& volume) {
  const hw::AcquisitionPlan& plan = volume.plan();
  const hw::StickIndex first = plan.index(plan.first_sequence(volume.volume_index()));
  return volume.frame(static_cast<int>(first.frame)).arrived.at(first.line) != 0;
}

}  // namespace

hw::PolarVolume whole_volume(hw::Board& board,
                             hw::VolumeAssembly& assembly,
                             const std::string& arguments) {
  const auto deadline = hw::HostClock::now() + kVolumeTimeout;
  auto volume = assembly.next(deadline);
  if (volume && !has_first_stick(*volume) && !assembly.ended()) {
    if (auto next = assembly.next(deadline)) volume = std::move(next);
  }
  if (!volume) {
    throw NoVolume("--board " + arguments + ": no volume came; " + ending_of(board, assembly));
  }
  return std::move(*volume);
}

std::string ending_of(hw::Board& board, const hw::VolumeAssembly& assembly) {
  if (!assembly.ended()) {
    return "nothing arrived for " + std::to_string(kVolumeTimeout.count()) + " minutes";
  }
  const hw::Event event = board.next(hw::HostTime::min());
  if (const auto* lost = std::get_if<hw::DeviceLost>(&event)) return lost->reason;
  const auto* end = std::get_if<hw::EndOfStream>(&event);
  return end != nullptr && end->truncated ? "the stream is cut short" : "the stream is over";
}

}  // namespace wobblebench::bench
