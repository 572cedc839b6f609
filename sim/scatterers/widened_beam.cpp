#include "sim/scatterers/widened_beam.h"

#include <algorithm>
#include <cmath>

namespace wobblebench::sim {

namespace {

/// Ratios above are taken as 1.
constexpr float kHardlyLower = 0.98f;

ReachParabola times(const ReachParabola& reach, float factor) {
  return {factor * reach.at_face, factor * reach.slope, factor * reach.square};
}

}  // namespace

WidenedBeam::WidenedBeam(const ScattererScene& scene,
                         const StickBeam& beam,
                         std::span<const float> frequency_ratio,
                         double spacing_m)
    : scene_(scene), beam_(beam) {
  if (frequency_ratio.empty()) return;
  const float lowest = *std::min_element(frequency_ratio.begin(), frequency_ratio.end());
  if (lowest <= kHardlyLower) widen(frequency_ratio, spacing_m);
}

void WidenedBeam::widen(std::span<const float> frequency_ratio, double spacing_m) {
  rows_ = beam_.rows;
  const auto count = static_cast<int>(rows_.size());
  std::vector<float> ratio;
  for (int row = 0; row < count; ++row) {
    const double range_m = (row + 0.5) / scene_.table.rows_per_m();
    const auto sample =
        std::min(static_cast<std::size_t>(range_m / spacing_m), frequency_ratio.size() - 1);
    ratio.push_back(frequency_ratio[sample]);
    rows_[static_cast<std::size_t>(row)].lateral_columns_per_m *= ratio.back();
    rows_[static_cast<std::size_t>(row)].elevation_columns_per_m *= ratio.back();
    factor_.push_back(1 / ratio.back());
  }
  // A block is tested as a whole: the widest beam in it counts.
  const int window =
      1 + static_cast<int>(std::ceil(2 * scene_.cells.block_m * scene_.table.rows_per_m()));
  const std::vector<float> exact = factor_;
  for (int row = 0; row < count; ++row) {
    const auto from = exact.begin() + std::max(0, row - window);
    const auto to = exact.begin() + std::min(count, row + window + 1);
    factor_[static_cast<std::size_t>(row)] = *std::max_element(from, to);
  }
  bounds_ = beam_.bounds.widened([&](double range_m) {
    return static_cast<double>(factor_[static_cast<std::size_t>(scene_.table.row(range_m))]);
  });
  thin(ratio);
}

void WidenedBeam::thin(const std::vector<float>& ratio) {
  const auto last = static_cast<float>(scene_.thinned.size() - 1);
  const int window = scene_.window(), count = static_cast<int>(ratio.size());
  octaves_.resize(scene_.gains.size());
  for (std::size_t i = 0; i < octaves_.size(); ++i) {
    octaves_[i].contributes.assign(ratio.size(), 0);
    for (int row = 0; row < count; ++row) {
      const auto at = static_cast<std::size_t>(row);
      const float level = std::clamp((1 - ratio[at]) * ScattererScene::kThinningLevels, 0.0f, last);
      octaves_[i].rows.push_back(scene_.thinned[static_cast<std::size_t>(level)][i][at]);
      if (octaves_[i].rows.back().count == 0) continue;
      const auto begin = octaves_[i].contributes.begin();
      std::fill(
          begin + std::max(0, row - window), begin + std::min(count, row + window + 1), char{1});
    }
  }
}

BlockReach WidenedBeam::reach(std::size_t row) const {
  const BlockReach& reach = beam_.reaches[row];
  if (factor_.empty()) return reach;
  return {times(reach.lateral, factor_[row]), times(reach.elevation, factor_[row])};
}

bool WidenedBeam::contributes(std::size_t octave, std::size_t row) const {
  return (octaves_.empty() ? scene_.gains[octave].contributes : octaves_[octave].contributes)[row];
}

BeamProjection WidenedBeam::projection() const {
  BeamProjection projection = scene_.projection(beam_);
  if (!rows_.empty()) projection.rows = rows_.data();
  return projection;
}

BeamProjection WidenedBeam::projection(std::size_t octave) const {
  BeamProjection projection = this->projection();
  projection.octave = (octaves_.empty() ? scene_.gains[octave].rows : octaves_[octave].rows).data();
  return projection;
}

}  // namespace wobblebench::sim
