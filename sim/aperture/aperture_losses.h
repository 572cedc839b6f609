// Losses of all ways between the aperture and an echo, against those on the stick's axis.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "sim/aperture/beam_places.h"
#include "sim/aperture/cone.h"
#include "sim/aperture/loss_table.h"
#include "sim/receive/band_loss.h"
#include "sim/receive/stick_losses.h"
#include "sim/tissue/scanned_tissue.h"

namespace wobblebench::sim {

class ConeMean;
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
  static constexpr std::size_t kRecent = 3;

  /// Memory of as many volumes, where all of them have losses.
  static double bytes(const hw::AcquisitionPlan& plan);

  /// Shared by all who ask for the same volume.
  std::shared_ptr<const VolumeCorrections> volume(std::uint32_t number) const;

 private:
  friend class VolumeCorrections;

  const ScannedTissue* tissue_;
  hw::AcquisitionPlan plan_;
  hw::ProbeGeometry geometry_;
  double depth_m_;
  TissueLosses losses_;
  BandLoss band_;
  LossGrid grid_;
  ApertureCone cone_;
  BeamPlaces places_;
  mutable std::mutex mutex_;
  mutable std::vector<std::shared_ptr<const VolumeCorrections>> recent_;
};

/// Work that is done once for each frame, by whichever thread comes first.
class OncePerFrame {
 public:
  explicit OncePerFrame(int frames)
      : begun_(static_cast<std::size_t>(frames)), done_(static_cast<std::size_t>(frames)) {}

  /// Does `work(frame)` for frames `first` to `last` that nobody has begun, then waits for the
  /// others. If threads took them in order, one would wait for the other at each frame.
  void run(int first, int last, const std::function<void(int)>& work);

 private:
  std::vector<std::atomic<bool>> begun_;
  std::vector<std::once_flag> done_;
};

/// Corrections of one volume, computed frame by frame when they are first asked for.
class VolumeCorrections {
 public:
  /// `source` must outlive it.
  VolumeCorrections(const ApertureLosses& source, std::uint32_t number);

  std::uint32_t number() const { return number_; }
  /// Valid as long as this object.
  ApertureCorrection of(const hw::StickIndex& index) const;

 private:
  void trace(int frame) const;
  void follow(int frame, ConeMean& mean) const;
  void compute(int frame) const;
  std::span<float> nodes_of(int frame, std::vector<float>& values) const;

  const ApertureLosses& source_;
  std::uint32_t number_;
  mutable LossTable table_;
  mutable OncePerFrame traced_;
  mutable OncePerFrame followed_;
  mutable OncePerFrame computed_;
  mutable std::vector<char> differs_;    ///< whether a frame has corrections
  mutable std::vector<float> log_gain_;  ///< [frame][line][node]
  mutable std::vector<float> frequency_;
  mutable std::vector<float> parts_;  ///< [frame] as ConeMean::follow has them
};

/// Whether the options ask for these losses, and the materials lose different amounts.
bool has_aperture_losses(const SimulationOptions& options,
                         const std::vector<phantoms::Material>& materials);

}  // namespace wobblebench::sim
