// The two-way response of the probe to a point scatterer, in the image plane or across it, by
// summation over the sources of that plane. The echo of a point off both axes is very nearly the
// product of the two. Across it the sum depends on the way in the image plane, which differs from
// element to element: it is taken at the mean of those ways, which holds to first order.
#pragma once

#include <span>
#include <vector>

#include "sim/optics/pulse_band.h"
#include "sim/optics/stick_aperture.h"

namespace wobblebench::sim {

/// A point in one of the planes: along the stick, and across it.
struct PlanePoint {
  double axial_m;
  double offset_m;
};

/// Ways in the image plane between the elements and a point on the stick's axis: how much longer
/// than its range, on average.
struct InPlaneExcess {
  double sent_m = 0;
  double received_m = 0;

  InPlaneExcess() = default;
  /// Of a point at `range_m`: means over the elements by their shares in the sum of the centre's
  /// frequency.
  InPlaneExcess(const StickAperture& aperture,
                const hw::AcquisitionPlan& plan,
                const PulseBand& band,
                double range_m);
};

/// One stick at one range: the focus of transmission that serves it, and receive focus there.
class PlaneResponse {
 public:
  /// In the image plane: elements with their directivity, fixed transmit focus, dynamic receive
  /// focus.
  static PlaneResponse lateral(const StickAperture& aperture,
                               const hw::AcquisitionPlan& plan,
                               const PulseBand& band,
                               double range_m);
  /// Across it: the lens's fixed focus on both ways. `excess`: of the range of its points.
  static PlaneResponse elevation(const ElevationSources& sources,
                                 const PulseBand& band,
                                 const InPlaneExcess& excess);

  /// Responses at the nodes of the band, without the phase of the way along the stick,
  /// exp(-2 i k axial). Not normalised: sums over sources.
  std::vector<PulseBand::Values> at(std::span<const PlanePoint> points) const;

 private:
  /// Weight and delay of a source as phasors at the nodes.
  struct Phasors {
    float re[PulseBand::kNodes];
    float im[PulseBand::kNodes];
  };
  struct Source {
    float axial_m;
    float lateral_m;
    float normal_axial;
    float normal_lateral;
    float lens_m;
    Phasors transmit;
    Phasors receive;
  };

  explicit PlaneResponse(const PulseBand& band) : band_(band) {}
  Phasors phasors(double weight, double delay_m) const;

  PulseBand band_;
  double half_width_m_ = 0;  ///< of an element, for its directivity
  bool spreads_ = false;     ///< amplitude falls with the distance (counted in one plane only)
  std::vector<Source> sources_;
};

}  // namespace wobblebench::sim
