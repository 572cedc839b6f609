// Propagation of sound along one stick: the tissue that it crosses, its losses, the specular echoes
// of interfaces, and clutter.
#pragma once

#include <complex>
#include <memory>
#include <span>

#include "hw/probe/acquisition_plan.h"
#include "sim/clutter/haze.h"
#include "sim/clutter/reverberation.h"
#include "sim/clutter/uneven_tissue.h"
#include "sim/losses/aperture_losses.h"
#include "sim/losses/stick_losses.h"
#include "sim/optics/pulse_band.h"
#include "sim/options.h"
#include "sim/speckle/scatterers/scatterer_field.h"
#include "sim/tissue/scanned_tissue.h"
#include "sim/tissue/stick_track.h"

namespace wobblebench::sim {

/// The path up to the last visible echo of scatterers. Valid as long as `losses` is unchanged.
StickPath visible_path(const TimedRay& line, double spacing_m, const StickLosses& losses);

/// The part of the computation that all models of IQ echoes share. Holds the working memory of one
/// thread.
class StickPropagation {
 public:
  /// `tissue` must outlive it. `surfaces`: the surfaces of which the track has layers.
  StickPropagation(const ScannedTissue& tissue,
                   const ProbeOptics& optics,
                   const SimulationOptions& options,
                   Surfaces surfaces);

  /// Computes the data that the sticks of a volume share, on all threads; otherwise the first stick
  /// does.
  void prepare(std::uint32_t volume) const {
    if (aperture_ != nullptr) aperture_->volume(volume);
    if (haze_ != nullptr) haze_->volume(volume);
  }
  /// Computes track and losses of a stick. Reuses the memory of the stick before.
  void follow(const hw::StickIndex& index);

  /// Angle of the stick in its image plane.
  double theta_rad() const { return stick_angle_rad(line_.ray); }
  const StickTrack& track() const { return track_; }
  const StickLosses& losses() const { return losses_; }
  StickPath path() const { return visible_path(line_, spacing_m_, losses_); }
  /// Makes the echoes of tissue, `iq` so far, uneven, if the options ask for it.
  void vary_tissue(std::span<std::complex<float>> iq) const;
  /// Adds reverberation and haze, if the options ask for them. `iq`: all echoes of the stick.
  void add_clutter(std::span<std::complex<float>> iq);
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
  double visible_;  ///< smallest amplitude of an echo that is not left out
  double depth_m_;  ///< largest true range of the last sample's echoes
  TimedRay line_;
  StickTrack track_;
  StickLosses losses_;
  std::shared_ptr<const ApertureLosses> aperture_;   ///< null: losses are those on the axis
  std::shared_ptr<const VolumeCorrections> volume_;  ///< of the current volume
  hw::StickIndex index_;
  UnevenTissue uneven_;
  Reverberation reverberation_;
  std::shared_ptr<const Haze> haze_;  ///< null: none
  std::shared_ptr<const HazeVolume> haze_volume_;
};

/// Highest centre frequency of the pulses at each range, over a sample of the sticks of volume 0
/// that still have echoes there; it determines the width of the beam. Empty where nothing absorbs.
/// Losses are those on the sticks' axes.
FrequencyCourse highest_frequency(const ScannedTissue& tissue,
                                  const ProbeOptics& optics,
                                  const SimulationOptions& options);

}  // namespace wobblebench::sim
