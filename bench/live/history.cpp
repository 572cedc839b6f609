#include "bench/live/history.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "base/units.h"

namespace wobblebench::bench {

namespace {

constexpr float kSteps = 255;

std::uint8_t packed(float sample) {
  // What is not finite is drawn black.
  return sample > 0 ? static_cast<std::uint8_t>(std::lrint(kSteps * std::min(sample, 1.0F))) : 0;
}

std::shared_ptr<const std::vector<PackedFrame>> packed(const std::vector<hw::PolarFrame>& frames) {
  auto all = std::make_shared<std::vector<PackedFrame>>();
  for (const hw::PolarFrame& frame : frames) {
    PackedFrame one{{}, frame.arrived, frame.motor_angle_rad};
    one.samples.reserve(frame.samples.size());
    for (const float sample : frame.samples) one.samples.push_back(packed(sample));
    all->push_back(std::move(one));
  }
  return all;
}

SharedFrames unpacked(const std::vector<PackedFrame>& frames) {
  auto all = std::make_shared<std::vector<hw::PolarFrame>>();
  for (const PackedFrame& frame : frames) {
    hw::PolarFrame one{{}, frame.arrived, frame.motor_angle_rad};
    one.samples.reserve(frame.samples.size());
    for (const std::uint8_t sample : frame.samples) {
      one.samples.push_back(static_cast<float>(sample) / kSteps);
    }
    all->push_back(std::move(one));
  }
  return all;
}

std::size_t bytes_of(const PastVolume& past) {
  std::size_t bytes = past.message.bytes->size() + past.depth_m.pixels.size() * sizeof(float) +
                      past.drawn.pixels.size();
  if (!past.frames) return bytes;
  for (const PackedFrame& frame : *past.frames) {
    bytes +=
        frame.samples.size() + frame.arrived.size() + frame.motor_angle_rad.size() * sizeof(double);
  }
  return bytes;
}

}  // namespace

LivePicture PastVolume::unpacked() const {
  LivePicture shown{.picture = {}, .state = state, .volume = volume, .frames = nullptr};
  shown.picture.depth_m = depth_m;
  shown.picture.drawn = drawn;
  if (frames) shown.frames = bench::unpacked(*frames);
  return shown;
}

void LiveHistory::add(const LivePicture& shown, LiveMessage message) {
  auto past = std::make_shared<PastVolume>();
  past->at = hw::HostClock::now();
  past->message = std::move(message);
  past->state = shown.state;
  past->volume = shown.volume;
  past->depth_m = shown.picture.depth_m;
  past->drawn = shown.picture.drawn;
  const std::lock_guard lock(mutex_);
  if (!volumes_.empty() && volumes_.back()->volume == shown.volume) {
    // Only settings have changed, as a rule.
    if (shown.frames == last_frames_) past->frames = volumes_.back()->frames;
    bytes_ -= volumes_.back()->bytes;
    volumes_.pop_back();
  }
  if (shown.frames && !past->frames) past->frames = packed(*shown.frames);
  last_frames_ = shown.frames;
  past->number = ++added_;
  past->bytes = bytes_of(*past);
  bytes_ += past->bytes;
  const hw::HostTime oldest = past->at - limits_.time;
  volumes_.push_back(std::move(past));
  while (volumes_.size() > 1 && (bytes_ > limits_.bytes || volumes_.front()->at < oldest)) {
    bytes_ -= volumes_.front()->bytes;
    volumes_.pop_front();
  }
}

void LiveHistory::clear() {
  const std::lock_guard lock(mutex_);
  volumes_.clear();
  last_frames_.reset();
  bytes_ = 0;
}

nlohmann::ordered_json LiveHistory::list() const {
  const std::lock_guard lock(mutex_);
  auto list = nlohmann::ordered_json::array();
  for (const auto& past : volumes_) {
    const double volume_s = to_seconds(past->state->scene.plan().volume_duration());
    list.push_back({{"number", past->number},
                    {"volume", past->volume},
                    {"device_s", past->volume * volume_s},
                    {"serial", past->state->serial}});
  }
  return list;
}

std::shared_ptr<const PastVolume> LiveHistory::find(std::uint64_t number) const {
  const std::lock_guard lock(mutex_);
  for (const auto& past : volumes_) {
    if (past->number == number) return past;
  }
  return nullptr;
}

}  // namespace wobblebench::bench
