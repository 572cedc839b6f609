// Cross-sections of the beam, packed for loops that look up one place for each scatterer: both
// directions of a sim/beam_table.h multiplied out, in 16-bit fractions.
#pragma once

#include <cstdint>
#include <vector>

#include "sim/beam_table.h"

namespace wobblebench::sim {

/// Columns run along both directions from the axis outwards.
class BeamSections {
 public:
  explicit BeamSections(const BeamTable& table);

  /// Two words for each place, [row][lateral column][elevation column]: level and colour, each with
  /// its real part in the low and its imaginary part in the high half.
  const std::uint32_t* words() const { return words_.data(); }
  /// What a row's fractions are to be multiplied by.
  float scale(int row) const { return scale_[static_cast<std::size_t>(row)]; }

 private:
  void add_row(const BeamTable& table, int row);

  std::vector<std::uint32_t> words_;
  std::vector<float> scale_;
};

}  // namespace wobblebench::sim
