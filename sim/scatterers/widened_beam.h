// The beam of a stick whose pulse has lost its high frequencies (sim/beam/table/lower_frequency.h):
// wider, and with fewer scatterers, so that as many remain in a resolution cell.
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
  /// True where scatterers of a block centred in the row may contribute.
  bool contributes(std::size_t octave, std::size_t row) const;
  /// For project_point(), and for the scatterers of an octave.
  BeamProjection projection() const;
  BeamProjection projection(std::size_t octave) const;

 private:
  void widen(std::span<const float> frequency_ratio, double spacing_m);
  /// Puts the rows of a lower frequency in the place of one; returns the factor on tissue.
  float lower(int row, float ratio);
  void take_widest();
  void thin(const std::vector<float>& tissue_gain);

  const ScattererScene& scene_;
  const StickBeam& beam_;
  std::vector<BeamBounds::Factor> factor_;  ///< largest about each row; empty: 1
  std::optional<BeamBounds> bounds_;
  std::vector<BeamAtRow> rows_;
  struct Octave {
    std::vector<OctaveAtRow> rows;
    std::vector<char> contributes;
  };
  std::vector<Octave> octaves_;
};

}  // namespace wobblebench::sim
