#include "sim/speckle/scatterers/echo_queue.h"

#include <algorithm>
#include <cmath>

#include "sim/speckle/scatterers/scatterer_field.h"
#include "sim/speckle/scatterers/scatterer_scene.h"
#include "sim/speckle/scatterers/stream_compaction.h"

namespace wobblebench::sim {

namespace {

/// Echoes are computed when there are this many scatterers: their arrays fit the first-level cache.
constexpr std::size_t kBatch = 1024;

}  // namespace

EchoRange::EchoRange(const ScattererScene& scene, const StickPath& path) {
  // Half a pulse reaches the last sample from beyond it.
  const double samples = static_cast<double>(path.remaining.size()) + scene.taps.half_length();
  apparent_m = samples * path.spacing_m;
  true_m = apparent_m - (path.delay_m.empty() ? 0 : static_cast<double>(path.delay_m.back()));
}

void EchoQueue::begin(const ScattererScene& scene, const StickPath& path) {
  scene_ = &scene;
  path_ = &path;
  beam_ = &scene.beam(path.line.ray);
  pending_ = 0;
  total_ = 0;
  bins_.begin(scene.taps, EchoRange(scene, path).apparent_m);
  tabulate_delays();
}

ProjectedScatterers EchoQueue::reserve(std::size_t count) {
  const std::size_t needed = pending_ + count + kCompactionWidth;
  if (range_m_.size() < needed) {
    range_m_.resize(2 * needed);
    table_index_.resize(2 * needed);
    amplitude_.resize(2 * needed);
  }
  return ProjectedScatterers{range_m_.data(), table_index_.data(), amplitude_.data()}.from(
      pending_);
}

void EchoQueue::commit(int count) {
  pending_ += static_cast<std::size_t>(count);
  if (pending_ >= kBatch) make_echoes();
}

std::uint64_t EchoQueue::finish(std::span<std::complex<float>> iq) {
  make_echoes();
  bins_.finish(scene_->taps, {path_->remaining, path_->frequency_ratio}, iq);
  return total_;
}

void EchoQueue::make_echoes() {
  if (!delay_m_.empty()) add_delays();
  const EchoConstants constants = scene_->echo_constants(*beam_, bins_.last_bin());
  const ProjectedScatterers scatterers{range_m_.data(), table_index_.data(), amplitude_.data()};
  for (std::size_t first = 0; first < pending_; first += kEchoBatch) {
    const int count = static_cast<int>(std::min<std::size_t>(kEchoBatch, pending_ - first));
    bins_.add(scatterers.from(first), count, constants);
  }
  total_ += pending_;
  pending_ = 0;
}

void EchoQueue::tabulate_delays() {
  delay_m_.clear();
  if (path_->delay_m.empty()) return;
  const auto delay = [&](std::size_t i) { return static_cast<double>(path_->delay_m[i]); };
  const auto true_at = [&](std::size_t i) {
    return (static_cast<double>(i) + 0.5) * path_->spacing_m - delay(i);
  };
  const std::size_t last = path_->delay_m.size() - 1;
  std::size_t i = 0;
  const int count =
      static_cast<int>(std::ceil(EchoRange(*scene_, *path_).true_m / path_->spacing_m)) + 1;
  for (int k = 0; k < count; ++k) {
    const double range = k * path_->spacing_m;
    while (i + 1 < last && true_at(i + 1) < range) ++i;
    const std::size_t next = std::min(i + 1, last);
    const double step = true_at(next) - true_at(i);
    const double share = step > 0 ? std::clamp((range - true_at(i)) / step, 0.0, 1.0) : 0.0;
    delay_m_.push_back(static_cast<float>(delay(i) + share * (delay(next) - delay(i))));
  }
}

void EchoQueue::add_delays() {
  for (std::size_t i = 0; i < pending_; ++i) range_m_[i] += delay_at(range_m_[i]);
}

float EchoQueue::delay_at(float range_m) const {
  const float per_m = static_cast<float>(1 / path_->spacing_m);
  const int last = static_cast<int>(delay_m_.size()) - 2;
  const float position = std::max(0.0f, range_m * per_m);
  const int before = std::clamp(static_cast<int>(position), 0, last);
  const float* delay = delay_m_.data() + before;
  const float share = std::min(position - static_cast<float>(before), 1.0f);
  return delay[0] + share * (delay[1] - delay[0]);
}

float EchoQueue::front_gain(const CrossedInterface& interface, float& range_m) const {
  constexpr float kFromEnd = 0.01F;  // far more than the rounding of a position
  if (path_->fronts.empty()) return 1;
  const auto spacing_m = static_cast<float>(path_->spacing_m);
  const float apparent_m = range_m + (delay_m_.empty() ? 0.0f : delay_at(range_m));
  const float position = apparent_m / spacing_m, sample = std::floor(position);
  const InterfaceFront* front =
      front_at(path_->fronts, interface.before, interface.behind, static_cast<int>(sample));
  if (front == nullptr) return 1;
  const float within = std::clamp(position - sample, kFromEnd, 1 - kFromEnd);
  range_m += (sample + within - position) * spacing_m;
  return front->remaining / path_->remaining[static_cast<std::size_t>(sample)];
}

}  // namespace wobblebench::sim
