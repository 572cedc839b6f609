// Slow variation of tissue's backscatter, fixed in the tissue.
#pragma once

#include <complex>
#include <cstdint>
#include <span>
#include <vector>

#include "sim/losses/stick_losses.h"
#include "sim/options.h"
#include "sim/tissue/scanned_tissue.h"
#include "sim/tissue/stick_track.h"

namespace wobblebench::sim {

/// The backscatter of tissue, and of its rough interfaces, is log-normal over distances of
/// ClutterOptions::tissue_grain_m, with the mean power of the material. Behind fluid the standard
/// deviation in dB grows linearly over ClutterOptions::even_skin_m. The factor is that on the
/// stick's axis: it varies little across a beam.
class UnevenTissue {
 public:
  /// `tissue` must outlive it.
  UnevenTissue(const ScannedTissue& tissue, const SimulationOptions& options, double spacing_m);

  /// Multiplies the echoes of tissue along one stick, samples at ranges (i + 1/2) * spacing_m.
  /// Track and losses are the stick's.
  void apply(const TimedRay& line,
             const StickTrack& track,
             const StickLosses& losses,
             std::span<std::complex<float>> iq) const;

 private:
  struct Fluid {
    double from_m, to_m;  ///< apparent ranges
  };
  std::vector<Fluid> fluids(const StickTrack& track, const StickLosses& losses) const;
  double sigma_db(std::span<const Fluid> fluids, double range_m) const;

  const ScannedTissue* tissue_;
  double sigma_db_;
  double grain_m_;
  double skin_m_;
  double spacing_m_;
  std::uint64_t key_;
};

}  // namespace wobblebench::sim
