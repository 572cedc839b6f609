#include "bench/pipeline/whole_volume.h"

#include <utility>
#include <variant>

namespace wobblebench::bench {

namespace {

/// The volume's first stick is there: it was not joined under way.
bool begins(const hw::PolarVolume& volume) {
  const hw::AcquisitionPlan& plan = volume.plan();
  const hw::StickIndex first = plan.index(plan.first_sequence(volume.volume_index()));
  return volume.frame(static_cast<int>(first.frame)).arrived.at(first.line) != 0;
}

}  // namespace

hw::PolarVolume whole_volume(hw::Board& board,
                             hw::VolumeAssembly& assembly,
                             const std::string& arguments) {
  const auto patience = hw::HostClock::now() + kPatience;
  auto volume = assembly.next(patience);
  if (volume && !begins(*volume) && !assembly.ended()) {
    if (auto next = assembly.next(patience)) volume = std::move(next);
  }
  if (!volume) {
    throw NoVolume("--board " + arguments + ": no volume came; " + ending_of(board, assembly));
  }
  return std::move(*volume);
}

std::string ending_of(hw::Board& board, const hw::VolumeAssembly& assembly) {
  if (!assembly.ended()) {
    return "nothing arrived for " + std::to_string(kPatience.count()) + " minutes";
  }
  const hw::Event event = board.next(hw::HostTime::min());
  if (const auto* lost = std::get_if<hw::DeviceLost>(&event)) return lost->reason;
  const auto* end = std::get_if<hw::EndOfStream>(&event);
  return end != nullptr && end->truncated ? "the stream is cut short" : "the stream is over";
}

}  // namespace wobblebench::bench
