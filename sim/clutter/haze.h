// Haze: a speckled floor of sound from beside the stick and of sound that was scattered repeatedly.
#pragma once

#include <complex>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "hw/probe/acquisition_plan.h"
#include "sim/losses/stick_losses.h"
#include "sim/optics/probe_optics.h"
#include "sim/options.h"
#include "sim/recent_volumes.h"
#include "sim/speckle/iq_field.h"
#include "sim/tissue/scanned_tissue.h"

namespace wobblebench::sim {

class HazeVolume;

/// The mean power of the haze at a point is that of the echoes around it, times ClutterOptions::
/// haze_db: their mean over angle, weighted with exp(-angle / reach) in the image plane and across
/// it, each followed by a tail exp(-range / trail). Side lobes return sound from beside the stick
/// at the same time; sound that takes more than one scatterer returns later. The level varies
/// slowly, as clutter does in patches and streaks. Times speckle with the beam's correlation, fixed
/// to the sticks, it is added to the echoes. Const functions may be called from several threads.
class Haze {
 public:
  /// `tissue` must outlive it. `depth_m`: true range of the sticks' ends.
  Haze(const ScannedTissue& tissue,
       const ProbeOptics& optics,
       const SimulationOptions& options,
       double depth_m);

  /// The haze of a volume, shared between calls. The first call computes it while others wait.
  std::shared_ptr<const HazeVolume> volume(std::uint32_t number) const;

  /// Adds a stick's haze to its echoes.
  void add(const HazeVolume& volume,
           const hw::StickIndex& index,
           std::span<std::complex<float>> iq) const;

 private:
  friend class HazeVolume;

  const ScannedTissue* tissue_;
  hw::AcquisitionPlan plan_;
  SimulationOptions options_;
  double depth_m_;
  double spacing_m_;
  IqField speckle_;  ///< of unit power
  mutable RecentVolumes<HazeVolume> recent_;
};

/// Amplitude of the haze on some sticks of a volume, at equidistant ranges.
class HazeVolume {
 public:
  HazeVolume(const Haze& source, std::uint32_t number);

  std::uint32_t number() const { return number_; }
  double step_m() const { return step_m_; }
  /// Amplitudes of any stick at the ranges (i + 1/2) * step_m().
  std::vector<float> of(const hw::StickIndex& index) const;

 private:
  /// Sticks or frames `count` of `all`, of which the haze is computed, at equal distances.
  struct Axis {
    int all;
    int count;
    double step_rad;

    /// Index of one of them among all.
    double place(int i) const {
      return count == 1 ? 0.5 * (all - 1) : i * (all - 1.0) / (count - 1);
    }
    static Axis of(int all, double between_rad, double reach_rad);
  };

  void trace(const Haze& source);
  void add_echoes(const StickTrack& track,
                  const StickLosses& losses,
                  const Haze& source,
                  std::span<float> power) const;
  void spread(const Axis& axis, std::size_t stride, double reach_rad);
  void trail(double length_m);
  void set_level(const Haze& source);

  std::uint32_t number_;
  Axis frames_;
  Axis lines_;
  int ranges_;
  double step_m_;
  std::vector<float> values_;  ///< [frame][line][range]: power, in the end amplitude
};

}  // namespace wobblebench::sim
