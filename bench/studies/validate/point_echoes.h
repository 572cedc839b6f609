// Echoes of given points, as a rung's own sum makes them.
#pragma once

#include <complex>
#include <functional>
#include <span>
#include <vector>

#include "hw/probe/acquisition_plan.h"
#include "sim/options.h"
#include "sim/speckle/scatterers/scatterer_field.h"

namespace wobblebench::bench {

/// What a stick's way takes from the pulse, at each of the plan's samples; empty: nothing.
struct WayLoss {
  std::vector<float> remaining;
  std::vector<float> frequency_ratio;  ///< of its centre
};

/// Points in fluid that does not echo, each stick with the same loss on its way. Const functions
/// may be called from several threads.
class PointEchoes {
 public:
  /// Rungs `scatterers` and `reference`. The plan's samples must be so fine that IQ samples are not
  /// finer: std::invalid_argument.
  PointEchoes(sim::Rung rung, const hw::AcquisitionPlan& plan, bool side_lobes, WayLoss loss = {});

  /// Of the stick at these angles, at the plan's samples; 1 is the peak for a point of amplitude 1
  /// on the middle stick at the same range.
  std::vector<double> envelope(double theta_rad,
                               double phi_rad,
                               std::span<const sim::PointEcho> points) const;

 private:
  using AddPoints = std::function<void(
      const sim::StickPath&, std::span<const sim::PointEcho>, std::span<std::complex<float>>)>;

  hw::AcquisitionPlan plan_;
  WayLoss loss_;
  AddPoints add_;
};

}  // namespace wobblebench::bench
