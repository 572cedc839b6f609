// What absorption leaves of the echo of tissue, relative to that of a mirror.
#pragma once

#include <vector>

#include "sim/losses/stick_losses.h"
#include "sim/optics/beam_profile.h"

namespace wobblebench::sim {

/// The echo of tissue and of rough surfaces comes from all places across the beam. The lower the
/// frequency, the wider the beam and, out of focus, the weaker its waves: the mean power W(f) that
/// a scatterer's neighbourhood returns falls with frequency. As absorption lowers the spectrum
/// S(f), tissue therefore keeps more of its echo than a mirror does. The squared gain after n
/// nepers at f0, there and back, is
///   [sum S^2 W exp(-2 n f / f0) / sum S^2 W] / [sum S exp(-n f / f0) / sum S]^2,
/// with the beam of the middle stick at the range; at the ends of the sector it differs by less
/// than 0.8 dB. The echoes of scatterers have this gain by themselves.
class TissueGain {
 public:
  /// `spacing_m`, `samples`: of a stick at the IQ rate.
  TissueGain(const ProbeOptics& optics, double spacing_m, int samples);

  /// Factor on the amplitude; `frequency_ratio`: BandLoss::frequency_ratio() of the losses.
  float at(double range_m, float frequency_ratio) const {
    return interpolate(ranges_.range_at(range_m), frequency_ratio);
  }
  /// Replaces `remaining` by StickLosses::remaining() times the gain at each sample.
  void apply(const StickLosses& losses, std::vector<float>& remaining) const;

 private:
  float interpolate(const BeamGrid::Between& range, float frequency_ratio) const;
  void tabulate(const ProbeOptics& optics, int range);

  BeamGrid ranges_;
  std::vector<float> gain_;                    ///< [range][frequency ratio]
  std::vector<BeamGrid::Between> at_samples_;  ///< of every kStride-th sample
};

}  // namespace wobblebench::sim
