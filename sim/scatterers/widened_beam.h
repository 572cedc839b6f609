// The beam of a stick whose pulse has lost its high frequencies: wider by the ratio.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "sim/scatterers/scatterer_scene.h"

namespace wobblebench::sim {

/// Nothing is copied where nothing absorbs. Both arguments must outlive it.
class WidenedBeam {
 public:
  /// `frequency_ratio`: as in StickPath.
  WidenedBeam(const ScattererScene& scene,
              const StickBeam& beam,
              std::span<const float> frequency_ratio,
              double spacing_m);

  const BeamBounds& bounds() const { return bounds_ ? *bounds_ : beam_.bounds; }
  /// For blocks whose centre lies in a row of the table.
  BlockReach reach(std::size_t row) const;
  BeamProjection projection(const ScattererScene& scene,
                            const ScattererScene::OctaveGain* octave) const;

 private:
  const StickBeam& beam_;
  std::vector<float> factor_;  ///< largest about each row; empty: 1
  std::optional<BeamBounds> bounds_;
  std::vector<BeamAtRow> rows_;
};

}  // namespace wobblebench::sim
