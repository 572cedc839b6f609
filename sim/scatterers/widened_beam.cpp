#include "sim/scatterers/widened_beam.h"

#include <algorithm>
#include <cmath>

namespace wobblebench::sim {

namespace {

/// Ratios above are taken as 1.
constexpr float kHardlyLower = 0.98f;

ReachParabola times(const ReachParabola& reach, double by) {
  const auto factor = static_cast<float>(by);
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
  std::vector<float> tissue_gain;
  for (int row = 0; row < static_cast<int>(rows_.size()); ++row) {
    const double range_m = (row + 0.5) / scene_.table.rows_per_m();
    const auto sample =
        std::min(static_cast<std::size_t>(range_m / spacing_m), frequency_ratio.size() - 1);
    tissue_gain.push_back(lower(row, frequency_ratio[sample]));
  }
  thin(tissue_gain);
  take_widest();
  bounds_ = beam_.bounds.widened(
      [&](double range_m) { return factor_[static_cast<std::size_t>(scene_.table.row(range_m))]; });
}

float WidenedBeam::lower(int row, float ratio) {
  if (ratio > kHardlyLower) {
    factor_.push_back({1, 1});
    return 1;
  }
  const LowerBeam lower = scene_.lower.at(row, static_cast<double>(ratio));
  BeamAtRow& at = rows_[static_cast<std::size_t>(row)];
  const BeamAtRow sent = at;
  at.lateral_columns_per_m =
      static_cast<float>(lower.lateral_scale) *
      beam_.rows[static_cast<std::size_t>(lower.lateral_row)].lateral_columns_per_m;
  at.elevation_columns_per_m =
      static_cast<float>(lower.elevation_scale) *
      beam_.rows[static_cast<std::size_t>(lower.elevation_row)].elevation_columns_per_m;
  at.first_index =
      first_table_index(lower.lateral_row, lower.elevation_row, scene_.table.columns());
  at.point_gain = static_cast<float>(lower.point_gain);
  factor_.push_back(
      {static_cast<double>(sent.lateral_columns_per_m / at.lateral_columns_per_m),
       static_cast<double>(sent.elevation_columns_per_m / at.elevation_columns_per_m)});
  return static_cast<float>(lower.tissue_gain);
}

/// A block is tested as a whole: the widest beam in it counts.
void WidenedBeam::take_widest() {
  const int window =
      1 + static_cast<int>(std::ceil(2 * scene_.cells.block_m * scene_.table.rows_per_m()));
  const int count = static_cast<int>(factor_.size());
  const std::vector<BeamBounds::Factor> exact = factor_;
  for (int row = 0; row < count; ++row) {
    BeamBounds::Factor& widest = factor_[static_cast<std::size_t>(row)];
    for (int i = std::max(0, row - window); i < std::min(count, row + window + 1); ++i) {
      const BeamBounds::Factor& near = exact[static_cast<std::size_t>(i)];
      widest = {std::max(widest.lateral, near.lateral), std::max(widest.elevation, near.elevation)};
    }
  }
}

void WidenedBeam::thin(const std::vector<float>& tissue_gain) {
  const double last = static_cast<double>(scene_.thinned.size() - 1);
  const int window = scene_.window(), count = static_cast<int>(tissue_gain.size());
  std::vector<std::size_t> levels;
  for (const BeamBounds::Factor& factor : factor_) {
    const double ratio = 1 / std::sqrt(factor.lateral * factor.elevation);
    levels.push_back(static_cast<std::size_t>(
        std::clamp((1 - ratio) * ScattererScene::kThinningLevels, 0.0, last)));
  }
  octaves_.resize(scene_.gains.size());
  for (std::size_t i = 0; i < octaves_.size(); ++i) {
    octaves_[i].contributes.assign(tissue_gain.size(), 0);
    for (int row = 0; row < count; ++row) {
      const auto at = static_cast<std::size_t>(row);
      OctaveAtRow octave = scene_.thinned[levels[at]][i][at];
      octave.full *= tissue_gain[at];
      octave.partial *= tissue_gain[at];
      octaves_[i].rows.push_back(octave);
      if (octave.count == 0) continue;
      const auto begin = octaves_[i].contributes.begin();
      std::fill(
          begin + std::max(0, row - window), begin + std::min(count, row + window + 1), char{1});
    }
  }
}

BlockReach WidenedBeam::reach(std::size_t row) const {
  const BlockReach& reach = beam_.reaches[row];
  if (factor_.empty()) return reach;
  return {times(reach.lateral, factor_[row].lateral),
          times(reach.elevation, factor_[row].elevation)};
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
