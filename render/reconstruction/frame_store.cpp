#include "render/reconstruction/frame_store.h"

#include <stdexcept>
#include <string>
#include <utility>

#include "render/geometry/ray_sampling.h"
#include "render/geometry/slice_geometry.h"

namespace wobblebench::render {
namespace {

std::vector<std::vector<float>> empty_frames(const hw::AcquisitionOptions& scan) {
  const auto samples = static_cast<std::size_t>(scan.sticks_per_frame) *
                       static_cast<std::size_t>(scan.samples_per_stick);
  return {static_cast<std::size_t>(scan.frames_per_volume), std::vector<float>(samples, 0.0f)};
}

}  // namespace

void check_log_compressed(const hw::PolarVolume& volume) {
  if (volume.scale() == hw::SampleScale::log_compressed) return;
  throw std::invalid_argument(
      "the samples of the volume are linear envelopes; only log-compressed ones can be rendered");
}

FrameStore::FrameStore(const hw::AcquisitionPlan& plan, const RenderOptions& options)
    : lines_(static_cast<std::size_t>(plan.acquisition().sticks_per_frame)),
      samples_(static_cast<std::size_t>(plan.acquisition().samples_per_stick)),
      slices_per_layer_(options.pipeline.mode == PipelineMode::fast ? 2 : 1),
      weights_(frame_weights(options.ray_casting)),
      half_(static_cast<int>(weights_.size()) / 2),
      received_(empty_frames(plan.acquisition())),
      angles_(plan),
      arrived_(received_.size(), false) {
  if (options.reconstruction.sticks == Sticks::aligned) {
    aligned_ = empty_frames(dense_plan(plan, dense_factors(plan, options)).acquisition());
  }
  to_convert_ = converted().size();
  const int slices = static_cast<int>(to_convert_);
  changed_.assign(static_cast<std::size_t>(std::max(slices - slices_per_layer_ + 1, 1)), false);
}

void FrameStore::put(int index, const hw::PolarFrame& frame) {
  if (index < 0 || static_cast<std::size_t>(index) >= received_.size()) {
    throw std::out_of_range("frame " + std::to_string(index) + " of " +
                            std::to_string(received_.size()));
  }
  if (frame.samples.size() != lines_ * samples_) {
    throw std::invalid_argument("a frame of " + std::to_string(frame.samples.size()) +
                                " samples; the plan has " + std::to_string(lines_ * samples_));
  }
  std::vector<float>& samples = received_[static_cast<std::size_t>(index)];
  std::transform(frame.samples.begin(), frame.samples.end(), samples.begin(), clean_sample);
  if (frame.arrived.size() == lines_) fill_lost_sticks(frame.arrived, samples);
  angles_.put(index, frame);
  arrived_[static_cast<std::size_t>(index)] = true;
  if (!aligned_.empty()) return;
  // The first layer affected is the one whose last slice is the frame's first neighbour.
  const int last_layer = static_cast<int>(changed_.size()) - 1;
  const int first =
      std::min(std::max(first_neighbour(index) - slices_per_layer_ + 1, 0), last_layer);
  const int last = std::min(last_neighbour(index), last_layer);
  std::fill(changed_.begin() + first, changed_.begin() + last + 1, true);
}

void FrameStore::fill_lost_sticks(const std::vector<std::uint8_t>& arrived,
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

void FrameStore::put_aligned(std::vector<std::vector<float>> frames) {
  if (frames.size() != to_convert_) {
    throw std::logic_error("FrameStore: " + std::to_string(frames.size()) + " aligned frames for " +
                           std::to_string(to_convert_));
  }
  aligned_ = std::move(frames);
  changed_.assign(changed_.size(), true);
}

void FrameStore::drop_aligned() {
  if (aligned_.empty()) return;
  aligned_.clear();
  changed_.assign(changed_.size(), true);
}

bool FrameStore::volume_complete() const {
  return std::find(arrived_.begin(), arrived_.end(), false) == arrived_.end();
}

void FrameStore::begin_volume() {
  arrived_.assign(arrived_.size(), false);
}

const std::vector<std::vector<float>>& FrameStore::converted() const {
  return aligned_.empty() ? received_ : aligned_;
}

int FrameStore::first_neighbour(int slice) const {
  return std::max(slice - half_, 0);
}

int FrameStore::last_neighbour(int slice) const {
  return std::min(slice + half_, static_cast<int>(converted().size()) - 1);
}

bool FrameStore::is_complete(int layer) const {
  if (!aligned_.empty()) return volume_complete();
  const auto first = arrived_.begin() + first_neighbour(layer);
  const auto end = arrived_.begin() + last_neighbour(layer + slices_per_layer_ - 1) + 1;
  return std::find(first, end, false) == end;
}

std::vector<int> FrameStore::take_complete() {
  std::vector<int> taken;
  for (int layer = 0; layer < static_cast<int>(changed_.size()); ++layer) {
    if (!changed_[static_cast<std::size_t>(layer)] || !is_complete(layer)) continue;
    changed_[static_cast<std::size_t>(layer)] = false;
    taken.push_back(layer);
  }
  return taken;
}

std::vector<int> FrameStore::take_changed() {
  std::vector<int> taken;
  for (int layer = 0; layer < static_cast<int>(changed_.size()); ++layer) {
    if (changed_[static_cast<std::size_t>(layer)]) taken.push_back(layer);
  }
  changed_.assign(changed_.size(), false);
  return taken;
}

std::vector<WeightedFrame> FrameStore::taps(int slice) const {
  const int first = first_neighbour(slice), last = last_neighbour(slice);
  const auto weight = [&](int frame) {
    return weights_[static_cast<std::size_t>(frame - slice + half_)];
  };
  double total = 0;
  for (int frame = first; frame <= last; ++frame) total += weight(frame);
  std::vector<WeightedFrame> all;
  for (int frame = first; frame <= last; ++frame) {
    all.push_back(
        {&converted()[static_cast<std::size_t>(frame)], static_cast<float>(weight(frame) / total)});
  }
  return all;
}

std::vector<float> FrameStore::filtered(int slice) const {
  std::vector<float> sum(converted().front().size(), 0.0f);
  for (const auto& [samples, share] : taps(slice)) {
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += share * (*samples)[i];
  }
  return sum;
}

}  // namespace wobblebench::render
