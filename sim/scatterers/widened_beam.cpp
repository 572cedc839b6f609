#include "sim/scatterers/widened_beam.h"

#include <algorithm>

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
  widest_ = 1 / lowest;
  bounds_ = beam.bounds.widened(static_cast<double>(widest_));
  rows_ = beam.rows;
  for (std::size_t row = 0; row < rows_.size(); ++row) {
    const double range_m = (static_cast<double>(row) + 0.5) / scene.table.rows_per_m();
    const auto sample =
        std::min(static_cast<std::size_t>(range_m / spacing_m), frequency_ratio.size() - 1);
    rows_[row].lateral_columns_per_m *= frequency_ratio[sample];
    rows_[row].elevation_columns_per_m *= frequency_ratio[sample];
  }
}

BlockReach WidenedBeam::reach(std::size_t row) const {
  const BlockReach& reach = beam_.reaches[row];
  return {times(reach.lateral, widest_), times(reach.elevation, widest_)};
}

BeamProjection WidenedBeam::projection(const ScattererScene& scene,
                                       const ScattererScene::OctaveGain* octave) const {
  BeamProjection projection = scene.projection(beam_, octave);
  if (!rows_.empty()) projection.rows = rows_.data();
  return projection;
}

}  // namespace wobblebench::sim
