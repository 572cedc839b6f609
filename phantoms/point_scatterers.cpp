#include "phantoms/point_scatterers.h"

#include <algorithm>
#include <glm/common.hpp>
#include <stdexcept>

namespace wobblebench::phantoms {

void PointScatterers::add(const PointScatterer& fixed) {
  first_.push_back(keys_.size());
  keys_.push_back({0, fixed});
}

void PointScatterers::add_track(const std::vector<ScattererKey>& track) {
  const auto not_later = [](const ScattererKey& a, const ScattererKey& b) {
    return !(a.time_s < b.time_s);
  };
  if (track.empty() || std::ranges::adjacent_find(track, not_later) != track.end()) {
    throw std::logic_error("track of a scatterer: needs keys whose times rise");
  }
  if (track.size() == 1) return add(track.front().point);
  first_.push_back(keys_.size());
  keys_.insert(keys_.end(), track.begin(), track.end());
}

void PointScatterers::add(const PointScatterers& more) {
  const std::size_t before = keys_.size();
  for (const std::size_t first : more.first_) first_.push_back(before + first);
  keys_.insert(keys_.end(), more.keys_.begin(), more.keys_.end());
}

std::span<const ScattererKey> PointScatterers::track(std::size_t index) const {
  const std::size_t end = index + 1 < first_.size() ? first_[index + 1] : keys_.size();
  return std::span(keys_).subspan(first_[index], end - first_[index]);
}

PointScatterer PointScatterers::at(std::size_t index, double time_s) const {
  const auto keys = track(index);
  const auto after = std::ranges::upper_bound(keys, time_s, {}, &ScattererKey::time_s);
  if (after == keys.begin()) return keys.front().point;
  if (after == keys.end()) return keys.back().point;
  const ScattererKey &from = *(after - 1), &to = *after;
  const double share = (time_s - from.time_s) / (to.time_s - from.time_s);
  return {glm::mix(from.point.position_m, to.point.position_m, share),
          glm::mix(from.point.amplitude, to.point.amplitude, share)};
}

}  // namespace wobblebench::phantoms
