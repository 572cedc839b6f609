// Slow variation of tissue's backscatter, fixed in the tissue.
#pragma once

#include <complex>
#include <cstdint>
#include <span>

#include "sim/options.h"
#include "sim/tissue/scanned_tissue.h"

namespace wobblebench::sim {

/// The backscatter of tissue, and of its rough interfaces, is log-normal over distances of
/// ClutterOptions::tissue_grain_m, with the mean power of the material. The factor is that on the
/// stick's axis: it varies little across a beam.
class UnevenTissue {
 public:
  /// `tissue` must outlive it.
  UnevenTissue(const ScannedTissue& tissue, const SimulationOptions& options, double spacing_m);

  /// Multiplies the echoes of tissue along one stick, samples at true ranges (i + 1/2) * spacing_m.
  void apply(const TimedRay& line, std::span<std::complex<float>> iq) const;

 private:
  const ScannedTissue* tissue_;
  double sigma_db_;
  double grain_m_;
  double spacing_m_;
  std::uint64_t key_;
};

}  // namespace wobblebench::sim
