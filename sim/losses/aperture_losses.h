// Losses on all ray paths between the aperture and an echo, relative to those on the stick's axis.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "sim/losses/aperture_paths.h"
#include "sim/losses/loss_table.h"
#include "sim/losses/losses.h"
#include "sim/losses/stick_losses.h"
#include "sim/recent_volumes.h"
#include "sim/tissue/scanned_tissue.h"

namespace wobblebench::sim {

class VolumeCorrections;

/// The echo power of tissue is the mean over sample points across the beam, each with the losses on
/// its paths from the transmit aperture and to the receive aperture (section_sums.h). The losses on
/// a path beside a stick are interpolated between the sticks that it crosses, each traced at its
/// own time; beyond the sector and the fan they are those of the outermost sticks. Const functions
/// may be called from several threads; results do not depend on their number.
class ApertureLosses {
 public:
  /// `tissue` must outlive it. `depth_m`: true range of the sticks' ends.
  ApertureLosses(const ScannedTissue& tissue,
                 const ProbeOptics& optics,
                 const SimulationOptions& options,
                 double depth_m);

  /// Bytes for `kept` volumes and for the computation of one.
  static double bytes(const hw::AcquisitionPlan& plan, double depth_m, int kept);

  /// The corrections of a volume, shared between calls. The first call computes them on all threads
  /// while others wait.
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
  BeamSection section_;
  mutable RecentVolumes<VolumeCorrections> recent_;
};

/// Corrections of one volume.
class VolumeCorrections {
 public:
  VolumeCorrections(const ApertureLosses& source, std::uint32_t number);

  std::uint32_t number() const { return number_; }
  /// The result is valid as long as this object.
  ApertureCorrection of(const hw::StickIndex& index) const;

 private:
  LossGrid grid_;
  std::uint32_t number_;
  std::vector<float> log_gain_;  ///< [frame][line][node]
  std::vector<float> frequency_;
  std::vector<char> differs_;  ///< [frame][line]: whether a stick has a correction
};

/// True if the options ask for these losses and the losses of the materials differ.
bool has_aperture_losses(const SimulationOptions& options,
                         const std::vector<phantoms::Material>& materials);

}  // namespace wobblebench::sim
