#include "sim/scatterers/echo_queue.h"

#include <algorithm>
#include <cmath>

#include "sim/scatterers/scatterer_scene.h"

namespace wobblebench::sim {

namespace {

/// Echoes are made when there are this many: they stay in the first-level cache.
constexpr std::size_t kPending = 1024;

}  // namespace

HeardRange::HeardRange(const ScattererScene& scene, const StickPath& way) {
  // A pulse whose middle lies beyond the last sample is still heard there.
  const double samples = static_cast<double>(way.left.size()) + scene.taps.beside();
  apparent_m = samples * way.spacing_m;
  true_m = apparent_m - (way.delay_m.empty() ? 0 : static_cast<double>(way.delay_m.back()));
}

void EchoQueue::begin(const ScattererScene& scene, const StickPath& way) {
  scene_ = &scene;
  way_ = &way;
  pending_ = 0;
  total_ = 0;
  bins_.begin(scene.taps, HeardRange(scene, way).apparent_m);
  find_delays();
}

SeenScatterers EchoQueue::room_for(std::size_t scatterers) {
  const std::size_t needed = pending_ + scatterers + kFlagsTogether;
  if (path_m_.size() < needed) {
    path_m_.resize(2 * needed);
    places_.resize(2 * needed);
    amplitude_.resize(2 * needed);
  }
  return SeenScatterers{path_m_.data(), places_.data(), amplitude_.data()}.from(pending_);
}

void EchoQueue::take(int count) {
  pending_ += static_cast<std::size_t>(count);
  if (pending_ >= kPending) make_echoes();
}

std::uint64_t EchoQueue::finish(std::span<std::complex<float>> iq) {
  make_echoes();
  bins_.finish(scene_->taps, way_->left, iq);
  return total_;
}

void EchoQueue::make_echoes() {
  if (!delay_m_.empty()) delay_paths();
  const PulseTaps& taps = scene_->taps;
  const EchoConstants constants{
      scene_->table.lateral().values.data(),
      scene_->table.elevation().values.data(),
      static_cast<float>(scene_->cycles_per_m),
      static_cast<float>(1 / taps.bin_m()),
      bins_.last_bin(),
      static_cast<float>(1 / (2 * kPi * scene_->cycles_per_m * taps.bin_m()))};
  const SeenScatterers seen{path_m_.data(), places_.data(), amplitude_.data()};
  BinShare shares[kEchoBatch];
  std::int32_t at[kEchoBatch];
  for (std::size_t first = 0; first < pending_; first += kEchoBatch) {
    const int count = static_cast<int>(std::min<std::size_t>(kEchoBatch, pending_ - first));
    sim::make_echoes(seen.from(first), count, constants, shares, at);
    bins_.add(shares, at, count);
  }
  total_ += pending_;
  pending_ = 0;
}

void EchoQueue::find_delays() {
  delay_m_.clear();
  if (way_->delay_m.empty()) return;
  const auto delay = [&](std::size_t i) { return static_cast<double>(way_->delay_m[i]); };
  const auto true_at = [&](std::size_t i) {
    return (static_cast<double>(i) + 0.5) * way_->spacing_m - delay(i);
  };
  const std::size_t last = way_->delay_m.size() - 1;
  std::size_t i = 0;
  const int count =
      static_cast<int>(std::ceil(HeardRange(*scene_, *way_).true_m / way_->spacing_m)) + 1;
  for (int k = 0; k < count; ++k) {
    const double range = k * way_->spacing_m;
    while (i + 1 < last && true_at(i + 1) < range) ++i;
    const std::size_t next = std::min(i + 1, last);
    const double step = true_at(next) - true_at(i);
    const double share = step > 0 ? std::clamp((range - true_at(i)) / step, 0.0, 1.0) : 0.0;
    delay_m_.push_back(static_cast<float>(delay(i) + share * (delay(next) - delay(i))));
  }
}

void EchoQueue::delay_paths() {
  const float per_m = static_cast<float>(1 / way_->spacing_m);
  const int last = static_cast<int>(delay_m_.size()) - 2;
  for (std::size_t i = 0; i < pending_; ++i) {
    const float place = std::max(0.0f, path_m_[i] * per_m);
    const int before = std::clamp(static_cast<int>(place), 0, last);
    const float* delay = delay_m_.data() + before;
    const float share = std::min(place - static_cast<float>(before), 1.0f);
    path_m_[i] += delay[0] + share * (delay[1] - delay[0]);
  }
}

}  // namespace wobblebench::sim
