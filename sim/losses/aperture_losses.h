// Losses of all ways between the aperture and an echo, against those on the stick's axis.
#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "sim/losses/band_loss.h"
#include "sim/losses/beam_places.h"
#include "sim/losses/cone.h"
#include "sim/losses/loss_table.h"
#include "sim/losses/stick_losses.h"
#include "sim/tissue/scanned_tissue.h"

namespace wobblebench::sim {

class VolumeCorrections;

/// The power of an echo is that of tissue: the mean over the places in the beam, each with the ways
/// from the transmit and to the receive aperture that are left (place_sums.h). The losses of ways
/// beside a stick are those of the sticks that they pass, each traced at its own time; beyond the
/// sector and the fan, of the outermost sticks. Const functions may be called from several threads;
/// results do not depend on their number.
class ApertureLosses {
 public:
  /// `tissue` must outlive it. `depth_m`: true range of the sticks' ends.
  ApertureLosses(const ScannedTissue& tissue,
                 const hw::AcquisitionPlan& plan,
                 const SimulationOptions& options,
                 double depth_m);

  /// Volumes kept: a thread may still be in one when another begins the next.
  static constexpr int kRecent = 3;

  /// Memory of `kept` volumes, and of computing one.
  static double bytes(const hw::AcquisitionPlan& plan, double depth_m, int kept);

  /// Shared by all who ask for the same volume; the first computes it on all threads while the
  /// others wait.
  std::shared_ptr<const VolumeCorrections> volume(std::uint32_t number) const;

 private:
  friend class CorrectionMaker;
  friend class VolumeCorrections;

  const ScannedTissue* tissue_;
  hw::AcquisitionPlan plan_;
  hw::ProbeGeometry geometry_;
  int threads_;
  double depth_m_;
  TissueLosses losses_;
  BandLoss band_;
  LossGrid grid_;
  ApertureCone cone_;
  BeamPlaces places_;
  mutable std::mutex mutex_;
  mutable std::vector<std::shared_ptr<const VolumeCorrections>> recent_;
};

/// Corrections of one volume.
class VolumeCorrections {
 public:
  VolumeCorrections(const ApertureLosses& source, std::uint32_t number);

  std::uint32_t number() const { return number_; }
  /// Valid as long as this object.
  ApertureCorrection of(const hw::StickIndex& index) const;

 private:
  LossGrid grid_;
  std::uint32_t number_;
  std::vector<float> log_gain_;  ///< [frame][line][node]
  std::vector<float> frequency_;
  std::vector<char> differs_;  ///< [frame][line]: whether a stick has a correction
};

/// Whether the options ask for these losses, and the materials lose different amounts.
bool has_aperture_losses(const SimulationOptions& options,
                         const std::vector<phantoms::Material>& materials);

}  // namespace wobblebench::sim
