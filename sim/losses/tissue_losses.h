// What tissue and its interfaces take from a stick's echoes.
#pragma once

#include <vector>

#include "phantoms/material.h"
#include "sim/options.h"
#include "sim/tissue/stick_track.h"

namespace wobblebench::hw {
class AcquisitionPlan;
}

namespace wobblebench::sim {

/// Losses there and back, as far as the options ask for them.
class TissueLosses {
 public:
  /// What an interface lets through at least, so that an axis behind a total reflection can be
  /// compared with ways beside it. Echoes at this level, -140 dB, are invisible.
  static constexpr double kLeastTransmission = 1e-7;

  /// `materials` must outlive it.
  TissueLosses(const hw::AcquisitionPlan& plan,
               const SimulationOptions& options,
               const std::vector<phantoms::Material>& materials);

  /// Absorption at the centre frequency, for each metre of range.
  double nepers_per_m(phantoms::MaterialIndex material) const {
    return nepers_per_m_[static_cast<std::size_t>(material)];
  }
  /// Amplitude behind an interface over that before it, 1 - R^2; 0 at a total reflection.
  double transmission(const Interface& crossed) const;

 private:
  const std::vector<phantoms::Material>* materials_;
  bool interfaces_;
  std::vector<double> nepers_per_m_;  ///< of each material
};

}  // namespace wobblebench::sim
