// The correlation of the echoes of two frames' sticks, which hear the same scatterers.
#pragma once

#include <array>
#include <complex>
#include <functional>

#include "sim/optics/beam_row.h"

namespace wobblebench::sim {

/// Turning past a range: where a scatterer of the plane lies for a neighbour.
struct Turn {
  double step_rad;       ///< between neighbours
  int most_lags;         ///< neighbours that there are
  double coherence_rad;  ///< turn by which the aperture decorrelates, about
  /// Place, for a stick turned by an angle, of a scatterer at an offset at the range.
  std::function<PlanePoint(double offset_m, double turn_rad)> place;
};

/// The beam at a range across the image plane, the same for all sticks.
struct ElevationPlane {
  PlaneResponse response;
  SampledRow row;

  ElevationPlane(const hw::AcquisitionPlan& plan,
                 const PulseBand& band,
                 Apodisation apodisation,
                 double range_m);
};

/// A stick's beam at a range in the image plane.
SampledRow lateral_row(const hw::AcquisitionPlan& plan,
                       const PulseBand& band,
                       Apodisation apodisation,
                       double range_m,
                       double theta_rad);
/// Half its width: three lobes, and the shadow of the transmitting aperture.
double lateral_reach_m(const hw::AcquisitionPlan& plan, double range_m);

/// The power of each of the band's frequencies over a row, but for a common factor and the pulse's
/// own: out of focus low ones have more of it.
std::array<double, PulseBand::kNodes> node_powers(const SampledRow& row);

/// The integral of h1 conj(h2) over the scatterers' places, for sticks that turn across the image
/// plane; 1 for one stick. Each frequency counts by its power in the image plane.
class FieldCorrelation {
 public:
  /// All must outlive it.
  FieldCorrelation(const ElevationPlane& plane,
                   const SampledRow& lateral,
                   const Turn& turn,
                   const PulseBand& band);

  /// A stick beyond the end of the array may have no aperture.
  bool silent() const { return !(power_ > 0); }
  std::complex<double> at(double turn_rad) const;

 private:
  /// What a stick hears of the scatterers about the middle one.
  struct Heard {
    double middle_m;  ///< axial place of the scatterer at offset 0
    std::vector<PlanePoint> places;
    std::vector<PulseBand::Values> values;
  };
  Heard turned(double turn_rad) const;
  double power(const Heard& heard) const;
  /// Not normalised.
  std::complex<double> product(const Heard& here, const Heard& there) const;

  const ElevationPlane& plane_;
  const Turn& turn_;
  std::array<double, PulseBand::kNodes> weights_, wavenumber_per_m_;
  double power_ = 0;
};

}  // namespace wobblebench::sim
