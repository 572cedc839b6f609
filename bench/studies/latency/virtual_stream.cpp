#include "bench/studies/latency/virtual_stream.h"

#include <algorithm>
#include <cmath>

#include "base/duration.h"
#include "base/hash.h"
#include "bench/studies/latency/service_times.h"
#include "sim/math/random.h"

namespace wobblebench::bench {

namespace {

/// Volumes whose service times follow each other as they were measured: a machine is slow for
/// seconds at a time, and in all stages (a moving-block bootstrap, docs/references.md [25]).
constexpr std::uint64_t kRun = 16;

class VirtualStream {
 public:
  explicit VirtualStream(const VirtualSetting& setting)
      : setting_(setting),
        frames_(setting.plan.acquisition().frames_per_volume),
        period_s_(setting.plan.stick_period_s()),
        announced_s_(frame_announcements_s(setting.plan, setting.card)) {}

  VirtualResult run();

 private:
  /// `each`: how many the pool has of a volume, of which this is number `which`.
  double draw(const TimePool& pool, std::uint64_t volume, int each = 1, int which = 0) const {
    const std::uint64_t hash = mix64(mix64(setting_.seed) + volume / kRun);
    const double share = unit_interval(hash);
    return pool.at(
        share,
        volume % kRun * static_cast<std::uint64_t>(each) + static_cast<std::uint64_t>(which));
  }
  double begin_s(int volume) const {
    const std::uint64_t first = setting_.plan.first_sequence(static_cast<std::uint32_t>(volume));
    return to_seconds(setting_.plan.stick_time(first).time_since_epoch());
  }
  double announced_s(int volume, int place) const;
  void acquire(int volume);
  int volume_to_begin(int last) const;
  void render(int volume);
  void hand_over(const VirtualPicture& picture);

  const VirtualSetting& setting_;
  const int frames_;
  const double period_s_;
  const std::vector<double> announced_s_;
  std::vector<std::vector<double>> acquired_s_;  ///< [volume][place]
  std::vector<double> popped_s_;                 ///< of a volume's last frame
  double reader_free_s_ = 0, renderer_free_s_ = 0;
  double taken_s_ = -1, written_s_ = 0;  ///< of the last picture: by the sink; written
  VirtualResult result_;
};

double VirtualStream::announced_s(int volume, int place) const {
  const double time_s = begin_s(volume) + announced_s_[static_cast<std::size_t>(place)];
  const auto& stall = setting_.stall;
  if (!stall || time_s >= stall->at_s + stall->for_s) return time_s;
  // What was sent before the stall is announced in it.
  constexpr double kSame_s = 1e-6;
  const int sticks = setting_.plan.sticks_per_volume() / frames_ * (place + 1);
  if (begin_s(volume) + sticks * period_s_ < stall->at_s + kSame_s) return time_s;
  return stall->at_s + stall->for_s;
}

/// Times at which the reader has pushed the frames of a volume.
void VirtualStream::acquire(int volume) {
  auto& acquired = acquired_s_.emplace_back();
  const std::size_t before = acquired_s_.size() - 1;
  const bool waits = setting_.queue.policy == StreamPolicy::every;
  for (int place = 0; place < frames_; ++place) {
    const double came_s = announced_s(volume, place) + draw(setting_.times.wake, before);
    double pushed_s = std::max(came_s, reader_free_s_);
    const auto room_after = static_cast<std::ptrdiff_t>(before) - setting_.queue.volumes;
    if (waits && place == 0 && room_after >= 0) {
      pushed_s = std::max(pushed_s, popped_s_.at(static_cast<std::size_t>(room_after)));
      // Sticks that came meanwhile wait in the ring, as far as it has room.
      const double held = (pushed_s - came_s) / period_s_;
      const double beyond = held - setting_.ring_slots;
      if (beyond > 0) result_.sticks_lost += static_cast<std::uint64_t>(beyond);
    }
    reader_free_s_ = pushed_s;
    acquired.push_back(pushed_s);
  }
}

/// The next volume; with `newest` the last one that is whole when the renderer is free.
int VirtualStream::volume_to_begin(int last) const {
  int begun = last + 1;
  if (setting_.queue.policy == StreamPolicy::every) return begun;
  for (int volume = begun; volume < setting_.volumes; ++volume) {
    if (acquired_s_[static_cast<std::size_t>(volume)].back() > renderer_free_s_) break;
    begun = volume;
  }
  return begun;
}

void VirtualStream::render(int volume) {
  const auto& acquired = acquired_s_[static_cast<std::size_t>(volume)];
  const auto number = static_cast<std::uint64_t>(volume);
  double free_s = renderer_free_s_;
  for (int place = 0; place < frames_; ++place) {
    const bool is_last = place + 1 == frames_;
    const double popped_s = std::max(free_s, acquired[static_cast<std::size_t>(place)]);
    if (is_last) popped_s_.push_back(popped_s);
    free_s = popped_s + (is_last ? draw(setting_.times.last_frame, number)
                                 : draw(setting_.times.frame, number, frames_ - 1, place));
  }
  const double picture_s = draw(setting_.times.picture, number);
  const double begin = begin_s(volume);
  hand_over({.volume = static_cast<std::uint32_t>(volume),
             .first_fired_s = begin,
             .last_fired_s = begin + (setting_.plan.sticks_per_volume() - 1) * period_s_,
             .announced_s = announced_s(volume, frames_ - 1),
             .acquired_s = acquired.back(),
             .ready_s = free_s + picture_s});
}

/// The queue of pictures holds one: with `every` the renderer waits until the sink takes it, with
/// `newest` it replaces it.
void VirtualStream::hand_over(const VirtualPicture& picture) {
  renderer_free_s_ = picture.ready_s;
  if (taken_s_ > picture.ready_s) {
    if (setting_.queue.policy == StreamPolicy::every) {
      renderer_free_s_ = taken_s_;
    } else {
      ++result_.superseded_pictures;
      result_.pictures.pop_back();
      // The sink is still at the picture before the one that is replaced.
      written_s_ = taken_s_;
    }
  }
  taken_s_ = std::max(renderer_free_s_, written_s_);
  written_s_ = taken_s_ + draw(setting_.times.written, picture.volume);
  result_.pictures.push_back(picture);
}

VirtualResult VirtualStream::run() {
  const bool all_first = setting_.queue.policy == StreamPolicy::newest;
  if (all_first) {
    for (int volume = 0; volume < setting_.volumes; ++volume) acquire(volume);
  }
  for (int last = -1; last + 1 < setting_.volumes;) {
    if (!all_first) acquire(last + 1);
    const int volume = volume_to_begin(last);
    result_.superseded_volumes += static_cast<std::uint64_t>(volume - last - 1);
    render(volume);
    last = volume;
  }
  return std::move(result_);
}

}  // namespace

VirtualResult run_virtual_stream(const VirtualSetting& setting) {
  check_options(setting.queue);
  return VirtualStream(setting).run();
}

namespace {

constexpr int kSeeds = 9;
constexpr int kVolumes = 300;
constexpr int kHalvings = 12;
/// Ends of the depths that an acquisition can have (AcquisitionOptions).
constexpr double kShallowest_m = 1e-3, kDeepest_m = 0.4;

bool loses(VirtualSetting setting, StreamPolicy policy, double depth_m, std::uint64_t seed) {
  hw::AcquisitionOptions acquisition = setting.plan.acquisition();
  acquisition.depth_m = depth_m;
  setting.plan = hw::AcquisitionPlan(setting.plan.probe(), acquisition);
  setting.queue.policy = policy;
  setting.volumes = kVolumes;
  setting.seed = seed;
  const VirtualResult result = run_virtual_stream(setting);
  return policy == StreamPolicy::every ? result.sticks_lost > 0 : result.superseded_volumes > 0;
}

/// The shallowest depth, by bisection of its logarithm, at which nothing is lost; the deepest if
/// something always is.
double first_loss_m(const VirtualSetting& setting, StreamPolicy policy, std::uint64_t seed) {
  double shallow = std::log(kShallowest_m), deep = std::log(kDeepest_m);
  if (!loses(setting, policy, kShallowest_m, seed)) return kShallowest_m;
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = 0.5 * (shallow + deep);
    (loses(setting, policy, std::exp(middle), seed) ? shallow : deep) = middle;
  }
  return std::exp(deep);
}

LineRate first_loss(const VirtualSetting& setting, StreamPolicy policy, const std::string& loss) {
  std::vector<double> rates;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    hw::AcquisitionOptions acquisition = setting.plan.acquisition();
    acquisition.depth_m = first_loss_m(setting, policy, seed);
    rates.push_back(1 / hw::AcquisitionPlan(setting.plan.probe(), acquisition).stick_period_s());
  }
  return {loss, spread_of(rates)};
}

}  // namespace

std::vector<LineRate> first_losses(const VirtualSetting& setting) {
  return {first_loss(setting, StreamPolicy::newest, "a volume, policy newest"),
          first_loss(setting, StreamPolicy::every, "a stick, policy every")};
}

}  // namespace wobblebench::bench
