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
    : beam_(beam) {
  if (frequency_ratio.empty()) return;
  const float lowest = *std::min_element(frequency_ratio.begin(), frequency_ratio.end());
  if (lowest > kHardlyLower) return;
  rows_ = beam.rows;
  const auto count = static_cast<int>(rows_.size());
  for (int row = 0; row < count; ++row) {
    const double range_m = (row + 0.5) / scene.table.rows_per_m();
    const auto sample =
        std::min(static_cast<std::size_t>(range_m / spacing_m), frequency_ratio.size() - 1);
    rows_[static_cast<std::size_t>(row)].lateral_columns_per_m *= frequency_ratio[sample];
    rows_[static_cast<std::size_t>(row)].elevation_columns_per_m *= frequency_ratio[sample];
    factor_.push_back(1 / frequency_ratio[sample]);
  }
  // A block is tested as a whole: the widest beam in it counts.
  const int window =
      1 + static_cast<int>(std::ceil(2 * scene.cells.block_m * scene.table.rows_per_m()));
  const std::vector<float> exact = factor_;
  for (int row = 0; row < count; ++row) {
    const auto from = exact.begin() + std::max(0, row - window);
    const auto to = exact.begin() + std::min(count, row + window + 1);
    factor_[static_cast<std::size_t>(row)] = *std::max_element(from, to);
  }
  bounds_ = beam.bounds.widened([&](double range_m) {
    return static_cast<double>(factor_[static_cast<std::size_t>(scene.table.row(range_m))]);
  });
}

BlockReach WidenedBeam::reach(std::size_t row) const {
  const BlockReach& reach = beam_.reaches[row];
  if (factor_.empty()) return reach;
  return {times(reach.lateral, factor_[row]), times(reach.elevation, factor_[row])};
}

BeamProjection WidenedBeam::projection(const ScattererScene& scene,
                                       const ScattererScene::OctaveGain* octave) const {
  BeamProjection projection = scene.projection(beam_, octave);
  if (!rows_.empty()) projection.rows = rows_.data();
  return projection;
}

}  // namespace wobblebench::sim
