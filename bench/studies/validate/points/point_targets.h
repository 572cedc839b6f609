// Echoes of given points, as a rung's own sum makes them.
#pragma once

#include <complex>
#include <functional>
#include <span>
#include <vector>

#include "bench/studies/validate/common/study_report.h"
#include "hw/probe/acquisition_plan.h"
#include "sim/options.h"
#include "sim/speckle/scatterers/scatterer_field.h"

namespace wobblebench::bench {

/// What the path along a stick takes from the pulse, at each of the plan's samples; empty: nothing.
struct PathLoss {
  std::vector<float> remaining;
  std::vector<float> frequency_ratio;  ///< of its centre
};

/// Points in fluid that does not echo, each stick with the same loss along it. Const functions
/// may be called from several threads.
class PointEchoes {
 public:
  /// Rungs `scatterers` and `reference`. The plan's samples must be so fine that IQ samples are not
  /// finer: std::invalid_argument.
  PointEchoes(sim::Rung rung, const hw::AcquisitionPlan& plan, bool side_lobes, PathLoss loss = {});

  /// Envelope of the stick at these angles, at the plan's samples; 1 is the peak for a point of
  /// amplitude 1 on the middle stick at the same range.
  std::vector<double> envelope(double theta_rad,
                               double phi_rad,
                               std::span<const sim::PointEcho> points) const;

 private:
  using AddPoints = std::function<void(
      const sim::StickPath&, std::span<const sim::PointEcho>, std::span<std::complex<float>>)>;

  hw::AcquisitionPlan plan_;
  PathLoss loss_;
  AddPoints add_;
};

/// A rung, and a choice that it offers.
struct PointRung {
  sim::Rung rung = sim::Rung::scatterers;
  bool side_lobes = false;
};

/// At each of `places`. `scatterers` and `reference`: one point on the axis of the stick, received
/// by sticks that turn past it in the image plane and by frames that turn past it; -6 dB widths of
/// the peak of the envelope, between the first places on either side of its maximum. `field`:
/// widths of its sim::BeamProfile, by which it blurs what it shows, those of each stick's own beam;
/// NaN along the stick, and for the level.
std::vector<BeamComparison> measure_points(hw::ProbePreset preset,
                                           const PointRung& rung,
                                           std::span<const BeamRow> places);

/// The same on the rung `scatterers` with the standard probe, in tissue of this one-way
/// attenuation, at rows of attenuated_rows(); level over that without attenuation.
std::vector<BeamComparison> measure_attenuated_points(double db_per_cm_mhz,
                                                      std::span<const BeamRow> places);

StudyReport point_target_report();

}  // namespace wobblebench::bench
