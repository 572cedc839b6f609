// The noiseless echoes of one stick, as the rung asks.
#pragma once

#include <complex>
#include <memory>
#include <span>

#include "sim/echo/iq_field.h"
#include "sim/fidelity.h"
#include "sim/receive/losses.h"
#include "sim/tissue/mean_power.h"
#include "sim/tissue/scanned_tissue.h"
#include "sim/tissue/stick_track.h"

namespace wobblebench::sim {

class ScattererField;
class ReferenceScene;

/// What all sticks share. Const functions may be called from several threads, each with its own
/// Worker.
class StickEchoes {
 public:
  StickEchoes(const ScannedTissue& subject,
              const hw::AcquisitionPlan& plan,
              const SimulationOptions& options,
              Rung rung);
  ~StickEchoes();

  /// Working memory of one thread.
  struct Worker {
    StickTrack track;
    StickLosses losses;
    MeanPower power;
    std::vector<float> mean_power;
  };
  Worker make_worker() const { return fresh_; }

  int samples() const { return samples_; }  ///< of a stick, at the IQ rate
  double spacing_m() const { return spacing_m_; }

  /// The stick's IQ samples; `iq` need not be clear.
  void make(const hw::StickIndex& index, Worker& worker, std::span<std::complex<float>> iq) const;

  /// What a rung needs to know of the surfaces around a stick.
  static Surfaces surfaces(Rung rung) {
    return rung == Rung::field ? Surfaces::nearby : Surfaces::crossed;
  }

  /// Farthest that a surface may lie from a stick and still be asked for.
  static double reach_m(const hw::AcquisitionPlan& plan, Rung rung);

 private:
  void modulate_speckle(const hw::StickIndex& index,
                        Worker& worker,
                        std::span<std::complex<float>> iq) const;
  void add_specular(const Worker& worker, std::span<std::complex<float>> iq) const;

  ScannedTissue subject_;
  hw::AcquisitionPlan plan_;
  SimulationOptions options_;
  Rung rung_;
  int samples_;
  double spacing_m_;
  double faintest_;  ///< amplitude of a specular echo that still shows
  double depth_m_;   ///< true range that the last sample can come from
  Worker fresh_;     ///< what a worker begins with: tables over the range
  IqField speckle_;  ///< rung `field`: even speckle
  std::unique_ptr<const ScattererField> scatterers_;  ///< rung `scatterers`
  std::unique_ptr<const ReferenceScene> reference_;   ///< rung `reference`
};

/// Where and when a stick looks.
TimedRay sightline(const hw::AcquisitionPlan& plan, const hw::StickIndex& index);

}  // namespace wobblebench::sim
