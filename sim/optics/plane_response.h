// The two-way response of the probe to a point scatterer, in the image plane or across it, by
// summation over the sources of that plane. The echo of a point off both axes is very nearly the
// product of the two. Across the image plane the sum depends on the path length within it, which
// differs between elements; it is computed for the mean path, which is correct to first order.
#pragma once

#include <span>
#include <vector>

#include "sim/optics/probe_optics.h"

namespace wobblebench::sim {

/// A point in one of the planes: along the stick, and across it.
struct PlanePoint {
  double axial_m;
  double offset_m;
};

/// Mean distance in the image plane between the elements and a point on the stick's axis, minus the
/// point's range.
struct InPlaneExcess {
  double sent_m = 0;
  double received_m = 0;

  InPlaneExcess() = default;
  /// For a point at `range_m`: means over the elements, weighted by their contributions at the
  /// centre frequency.
  InPlaneExcess(const StickAperture& aperture, double range_m);
};

/// The response of one stick's aperture, focused for one range: with the transmit focus that serves
/// it, and the receive focus at it.
class PlaneResponse {
 public:
  /// In the image plane: elements with their directivity.
  static PlaneResponse lateral(const StickAperture& aperture, double range_m);
  /// Across the image plane: the lens, whose focus is fixed on transmit and on receive. For points
  /// at `range_m` on the middle stick.
  static PlaneResponse elevation(const ProbeOptics& optics, double range_m);
  /// The same for points whose paths in the image plane are longer than their range by `excess`.
  static PlaneResponse elevation(const ProbeOptics& optics, const InPlaneExcess& excess);

  /// Responses at the nodes of the band, without the phase of the path along the stick,
  /// exp(-2 i k axial). Not normalised: sums over sources.
  std::vector<PulseBand::Values> at(std::span<const PlanePoint> points) const;
  /// Response at a point on the stick's axis.
  PulseBand::Values on_axis(double range_m) const;

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
  bool spreads_ = false;     ///< amplitude falls with distance; counted in one of the planes only
  std::vector<Source> sources_;
};

}  // namespace wobblebench::sim
