// The beam at one range, sampled from the responses over a row of offsets across it.
#pragma once

#include <array>
#include <functional>
#include <vector>

#include "sim/optics/plane_response.h"

namespace wobblebench::sim {

/// Responses at equidistant offsets, from -reach to reach or from 0 to reach.
struct SampledRow {
  double reach_m = 0;
  bool both_sides = false;
  std::vector<PulseBand::Values> values;

  double step_m() const {
    return (both_sides ? 2 : 1) * reach_m / static_cast<double>(values.size());
  }
  double offset_m(std::size_t column) const {
    return (static_cast<double>(column) + 0.5) * step_m() - (both_sides ? reach_m : 0);
  }
  /// Integral over the row, in metres, of the power at a node of the band.
  double power_m(std::size_t node) const;
  /// Power at each node of the band, summed over the row. Relative to the pulse's own spectrum, low
  /// frequencies have more of it out of focus.
  std::array<double, PulseBand::kNodes> node_powers() const;
};

/// Samples a response over a row at `range_m`, in `columns` per side.
SampledRow sample_row(
    const PlaneResponse& response, double range_m, double reach_m, bool both_sides, int columns);

/// The offset beyond which, on both sides together, the fraction `beyond` of the row's power lies,
/// for a pulse whose centre frequency is at `frequency_ratio` of the transmitted one.
double power_reach_m(const SampledRow& row,
                     const PulseBand& band,
                     double frequency_ratio,
                     double beyond);

/// A delay that varies as a parabola over the row.
struct RowDelay {
  double delay_m = 0;
  double tilt = 0;
  double curvature_per_m = 0;

  double at(double offset_m) const {
    return delay_m + (tilt + curvature_per_m * offset_m) * offset_m;
  }
};

/// Least-squares parabola through the group delays, weighted by power.
RowDelay fit_delay(const SampledRow& row, const PulseBand& band);

/// A row's responses with the delay removed, times `scale`.
std::vector<PulseBand::Values> aligned(const SampledRow& row,
                                       const RowDelay& delay,
                                       const PulseBand& band,
                                       double scale);

/// The beam at a range across the image plane, wide enough for speckle statistics; the same for all
/// sticks.
struct ElevationRow {
  PlaneResponse response;
  SampledRow row;

  ElevationRow(const ProbeOptics& optics, double range_m);
};
/// Such a row in the image plane, for one stick.
SampledRow lateral_row(const StickAperture& aperture, double range_m);
/// Half its width: three lobes, and the geometric shadow of the transmit aperture.
double lateral_row_reach_m(const ProbeOptics& optics, double range_m);

/// Where a beam is taken to end.
struct BeamReach {
  double beyond = 0;       ///< fraction of its power that is left out
  FrequencyCourse course;  ///< of the received pulses: the beam is wider at lower frequencies
};

/// One stick's beam in one direction across it, as a function of range.
class BeamPlane {
 public:
  /// In the image plane, for a stick at an angle.
  static BeamPlane lateral(const ProbeOptics& optics, double theta_rad, const BeamReach& reach);
  /// Across the image plane.
  static BeamPlane elevation(const ProbeOptics& optics, const BeamReach& reach);

  /// Largest offset at a range: where the given fraction of the power lies beyond, but at least
  /// most of the focused beam's main lobe.
  double reach_m(double range_m) const;
  /// Reaches at `count` equidistant ranges from `first_m` on, interpolated between every eighth.
  std::vector<double> reaches_m(double first_m, double step_m, int count) const;
  SampledRow sample(double range_m, double reach_m, int columns) const {
    return sample_row(response_(range_m), range_m, reach_m, both_sides_, columns);
  }
  PulseBand::Values on_axis(double range_m) const { return response_(range_m).on_axis(range_m); }

 private:
  using OfRange = std::function<double(double range_m)>;

  BeamPlane(const ProbeOptics& optics, const BeamReach& reach, bool both_sides);
  /// From the axis to the first zero of the focused beam.
  double lobe_m(double range_m) const {
    return optics_.wavelength_m() / reach_.course.at(range_m) * range_m / aperture_m_(range_m);
  }

  ProbeOptics optics_;
  std::function<PlaneResponse(double range_m)> response_;
  OfRange aperture_m_;  ///< on receive
  OfRange shadow_m_;    ///< geometric width of the transmitted beam
  BeamReach reach_;
  bool both_sides_;
};

}  // namespace wobblebench::sim
