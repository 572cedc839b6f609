#include "render/reconstruction/received_frames.h"

#include <algorithm>
#include <stdexcept>
#include <string>

#include "render/geometry/sample.h"

namespace wobblebench::render {

ReceivedFrames::ReceivedFrames(const hw::AcquisitionPlan& plan)
    : lines_(static_cast<std::size_t>(plan.acquisition().sticks_per_frame)),
      samples_(static_cast<std::size_t>(plan.acquisition().samples_per_stick)),
      frames_(static_cast<std::size_t>(plan.acquisition().frames_per_volume),
              std::vector<float>(lines_ * samples_, 0.0f)),
      arrived_(frames_.size(), false) {}

void ReceivedFrames::put(int index, const hw::PolarFrame& frame) {
  if (index < 0 || static_cast<std::size_t>(index) >= frames_.size()) {
    throw std::out_of_range("frame " + std::to_string(index) + " of " +
                            std::to_string(frames_.size()));
  }
  if (frame.samples.size() != lines_ * samples_) {
    throw std::invalid_argument("a frame of " + std::to_string(frame.samples.size()) +
                                " samples; the plan has " + std::to_string(lines_ * samples_));
  }
  std::vector<float>& samples = frames_[static_cast<std::size_t>(index)];
  std::transform(frame.samples.begin(), frame.samples.end(), samples.begin(), clean_sample);
  if (frame.arrived.size() == lines_) fill_lost_sticks(frame.arrived, samples);
  arrived_[static_cast<std::size_t>(index)] = true;
}

void ReceivedFrames::fill_lost_sticks(const std::vector<std::uint8_t>& arrived,
                                      std::vector<float>& samples) const {
  const auto stick = [&](std::size_t line) {
    return samples.begin() + static_cast<std::ptrdiff_t>(line * samples_);
  };
  constexpr std::size_t kNone = static_cast<std::size_t>(-1);
  std::size_t before = kNone;
  for (std::size_t line = 0; line < lines_; ++line) {
    if (arrived[line]) {
      before = line;
      continue;
    }
    std::size_t after = line + 1;
    while (after < lines_ && !arrived[after]) ++after;
    if (before == kNone && after == lines_) return;
    const bool has_both = before != kNone && after < lines_;
    const std::size_t low = before != kNone ? before : after, high = after < lines_ ? after : low;
    const float share = has_both ? float(line - low) / float(high - low) : 0.0f;
    std::transform(stick(low),
                   stick(low) + static_cast<std::ptrdiff_t>(samples_),
                   stick(high),
                   stick(line),
                   [share](float a, float b) { return (1 - share) * a + share * b; });
  }
}

bool ReceivedFrames::volume_complete() const {
  return std::find(arrived_.begin(), arrived_.end(), false) == arrived_.end();
}

void ReceivedFrames::begin_volume() {
  arrived_.assign(arrived_.size(), false);
}

}  // namespace wobblebench::render
