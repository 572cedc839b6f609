// Propagation of sound along one stick: the tissue on its way, its losses, and the specular echoes
// of the interfaces that it crosses.
#pragma once

#include <complex>
#include <memory>
#include <span>

#include "hw/probe/acquisition_plan.h"
#include "sim/losses/aperture_losses.h"
#include "sim/losses/stick_losses.h"
#include "sim/options.h"
#include "sim/speckle/scatterers/stick_path.h"
#include "sim/tissue/stick_track.h"

namespace wobblebench::sim {

/// Ends where echoes of scatterers are invisible. Valid as long as `losses` is unchanged.
StickPath visible_path(const TimedRay& line, double spacing_m, const StickLosses& losses);

/// What the models of IQ echoes have in common, with the working memory of one thread.
class StickPropagation {
 public:
  /// `tissue` must outlive it. `surfaces`: those that the track has to hold.
  StickPropagation(const ScannedTissue& tissue,
                   const hw::AcquisitionPlan& plan,
                   const SimulationOptions& options,
                   Surfaces surfaces);

  /// Computes what the sticks of a volume share, on all threads. Without it, the first stick does.
  void prepare(std::uint32_t volume) const {
    if (aperture_ != nullptr) aperture_->volume(volume);
  }
  /// Computes track and losses of a stick. Reuses the memory of the stick before.
  void follow(const hw::StickIndex& index);

  /// Angle of the stick in its image plane.
  double theta_rad() const { return stick_angle_rad(line_.ray); }
  const StickTrack& track() const { return track_; }
  const StickLosses& losses() const { return losses_; }
  StickPath path() const { return visible_path(line_, spacing_m_, losses_); }
  /// Adds a pulse for each interface that the stick crosses, if the options ask for them.
  void add_specular_echoes(std::span<std::complex<float>> iq) const;

  int samples() const { return samples_; }  ///< of a stick, at the IQ rate
  double spacing_m() const { return spacing_m_; }

 private:
  const ScannedTissue* tissue_;
  hw::AcquisitionPlan plan_;
  hw::ProbeGeometry geometry_;
  SimulationOptions options_;
  Surfaces surfaces_;
  int samples_;
  double spacing_m_;
  double visible_;  ///< amplitude below which an echo is left out
  double depth_m_;  ///< true range that the last sample can come from
  TimedRay line_;
  StickTrack track_;
  StickLosses losses_;
  std::shared_ptr<const ApertureLosses> aperture_;   ///< null: losses are those of the axis
  std::shared_ptr<const VolumeCorrections> volume_;  ///< the one in hand
};

}  // namespace wobblebench::sim
