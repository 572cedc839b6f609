#include "hw/probe/polar_volume.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <string>

namespace wobblebench::hw {
namespace {

PolarFrame empty_frame(const AcquisitionPlan& plan, std::uint32_t volume, std::uint32_t frame) {
  const auto lines = static_cast<std::size_t>(plan.acquisition().sticks_per_frame);
  const auto samples = static_cast<std::size_t>(plan.acquisition().samples_per_stick);
  PolarFrame empty;
  empty.samples.assign(lines * samples, 0.0F);
  empty.arrived.assign(lines, 0);
  for (std::uint32_t line = 0; line < lines; ++line) {
    empty.motor_angle_rad.push_back(plan.motor_angle_rad({volume, frame, line}));
  }
  return empty;
}

}  // namespace

void schedule(Stick& stick, const AcquisitionPlan& plan, std::uint64_t sequence) {
  stick.sequence = sequence;
  stick.index = plan.index(sequence);
  stick.time = plan.stick_time(sequence);
  stick.motor_angle_rad = plan.motor_angle_rad(stick.index);
  stick.sweep_direction = plan.sweep_direction(stick.index.volume);
}

PolarVolume::PolarVolume(const AcquisitionPlan& plan, std::uint32_t volume)
    : plan_(plan), volume_index_(volume) {
  const auto count = static_cast<std::uint32_t>(plan.acquisition().frames_per_volume);
  frames_.reserve(count);
  for (std::uint32_t frame = 0; frame < count; ++frame) {
    frames_.push_back(empty_frame(plan, volume, frame));
  }
}

PolarVolume PolarVolume::of_samples(const AcquisitionPlan& plan,
                                    std::uint32_t volume,
                                    SampleScale scale,
                                    std::span<const float> samples) {
  const auto length = static_cast<std::size_t>(plan.acquisition().samples_per_stick);
  const auto count = static_cast<std::size_t>(plan.sticks_per_volume());
  const std::uint64_t first = plan.first_sequence(volume);
  PolarVolume made(plan, volume);
  for (std::size_t i = 0; i < count; ++i) {
    const StickIndex index = plan.index(first + i);
    made.place_line(index, samples.subspan(i * length, length), plan.motor_angle_rad(index), scale);
  }
  return made;
}

void PolarVolume::place(const Stick& stick) {
  if (stick.index.volume != volume_index_) {
    throw std::out_of_range("a stick of volume " + std::to_string(stick.index.volume) +
                            " where volume " + std::to_string(volume_index_) + " is put together");
  }
  place_line(stick.index, stick.samples, stick.motor_angle_rad, stick.scale);
}

void PolarVolume::place_frame(int frame, const PolarFrame& from, SampleScale scale) {
  const std::size_t samples = from.samples.size() / from.arrived.size();
  for (std::size_t line = 0; line < from.arrived.size(); ++line) {
    if (from.arrived[line] == 0) continue;
    place_line({volume_index_, static_cast<std::uint32_t>(frame), static_cast<std::uint32_t>(line)},
               std::span(from.samples).subspan(line * samples, samples),
               from.motor_angle_rad[line],
               scale);
  }
}

void PolarVolume::place_line(const StickIndex& index,
                             std::span<const float> samples,
                             double motor_angle_rad,
                             SampleScale scale) {
  PolarFrame& frame = frames_.at(index.frame);
  std::uint8_t& arrived = frame.arrived.at(index.line);
  const auto planned = static_cast<std::size_t>(plan_.acquisition().samples_per_stick);
  if (samples.size() != planned) {
    throw std::invalid_argument("a stick of " + std::to_string(samples.size()) +
                                " samples where the plan has " + std::to_string(planned));
  }
  const auto first = frame.samples.begin() + static_cast<std::ptrdiff_t>(index.line * planned);
  std::copy(samples.begin(), samples.end(), first);
  frame.motor_angle_rad[index.line] = motor_angle_rad;
  arrived = 1;
  scale_ = scale;
}

void PolarVolume::log_compress(double dynamic_range_db) {
  if (scale_ == SampleScale::log_compressed) return;
  for (PolarFrame& frame : frames_) {
    for (float& sample : frame.samples) {
      if (!std::isfinite(sample)) continue;
      const double amplitude = std::max(static_cast<double>(sample), 0.0);
      const double value = 1 + 20 * std::log10(amplitude) / dynamic_range_db;  // -inf at 0
      sample = static_cast<float>(std::clamp(value, 0.0, 1.0));
    }
  }
  scale_ = SampleScale::log_compressed;
}

int PolarVolume::missing_sticks() const {
  std::ptrdiff_t missing = 0;
  for (const PolarFrame& frame : frames_) {
    missing += std::count(frame.arrived.begin(), frame.arrived.end(), std::uint8_t{0});
  }
  return static_cast<int>(missing);
}

}  // namespace wobblebench::hw
