#include "render/reconstruction/frame_store.h"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <utility>

namespace wobblebench::render {

FrameStore::FrameStore(const hw::AcquisitionPlan& plan,
                       const std::vector<double>& weights,
                       int slices_per_layer)
    : frames_(plan.acquisition().frames_per_volume),
      half_(static_cast<int>(weights.size()) / 2),
      slices_per_layer_(slices_per_layer),
      weights_(weights),
      samples_(static_cast<std::size_t>(plan.acquisition().sticks_per_frame) *
               static_cast<std::size_t>(plan.acquisition().samples_per_stick)),
      clean_(static_cast<std::size_t>(frames_), std::vector<float>(samples_, 0.0f)),
      arrived_(static_cast<std::size_t>(frames_), false),
      changed_(static_cast<std::size_t>(std::max(frames_ - slices_per_layer + 1, 1)), false) {}

int FrameStore::first_neighbour(int slice) const {
  return std::max(slice - half_, 0);
}

int FrameStore::last_neighbour(int slice) const {
  return std::min(slice + half_, frames_ - 1);
}

void FrameStore::put(int index, std::vector<float> samples) {
  if (index < 0 || index >= frames_) {
    throw std::out_of_range("frame " + std::to_string(index) + " of " + std::to_string(frames_));
  }
  if (samples.size() != samples_) {
    throw std::invalid_argument("a frame of " + std::to_string(samples.size()) +
                                " samples; the plan has " + std::to_string(samples_));
  }
  clean_[static_cast<std::size_t>(index)] = std::move(samples);
  arrived_[static_cast<std::size_t>(index)] = true;
  // The first layer affected is the one whose last slice is the frame's first neighbour.
  const int last_layer = static_cast<int>(changed_.size()) - 1;
  const int first =
      std::min(std::max(first_neighbour(index) - slices_per_layer_ + 1, 0), last_layer);
  const int last = std::min(last_neighbour(index), last_layer);
  std::fill(changed_.begin() + first, changed_.begin() + last + 1, true);
}

bool FrameStore::is_complete(int layer) const {
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

bool FrameStore::volume_complete() const {
  return std::find(arrived_.begin(), arrived_.end(), false) == arrived_.end();
}

void FrameStore::begin_volume() {
  arrived_.assign(arrived_.size(), false);
}

const std::vector<float>& FrameStore::filtered(int index) {
  const int first = first_neighbour(index), last = last_neighbour(index);
  if (first == last) return clean_[static_cast<std::size_t>(index)];
  double total = 0;
  for (int f = first; f <= last; ++f)
    total += weights_[static_cast<std::size_t>(f - index + half_)];
  filtered_.assign(samples_, 0.0f);
  for (int f = first; f <= last; ++f) {
    const auto share =
        static_cast<float>(weights_[static_cast<std::size_t>(f - index + half_)] / total);
    const float* frame = clean_[static_cast<std::size_t>(f)].data();
    for (std::size_t i = 0; i < samples_; ++i) filtered_[i] += share * frame[i];
  }
  return filtered_;
}

}  // namespace wobblebench::render
