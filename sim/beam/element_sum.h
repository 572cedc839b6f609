// The echo of single scatterers by direct summation over the elements of the probe, in double
// precision: linear acoustics in a homogeneous medium, frequency by frequency.
#pragma once

#include <complex>
#include <cstdint>
#include <span>
#include <vector>

#include "hw/probe/acquisition_plan.h"
#include "sim/tissue/stick_track.h"

namespace wobblebench::sim {

/// A place in beam coordinates, and the strength of its scatterer.
struct BeamPoint {
  glm::dvec3 at_m{0};  ///< axial, lateral, elevation
  double amplitude = 1;
};

/// The probe as one stick uses it. Elements lie on the curved face, each divided into point
/// sources, three along the face and so many across it that none is longer than half a wavelength
/// there. A lens focuses each across the image plane. Transmitted sound is delayed to meet at the
/// transmit focus, received sound to come from the range that is listened to. Apertures subtend
/// the F-number's angle as the focus sees them, so that they grow with its range; an element that
/// lies across an edge has the share of it that lies within.
class ElementSum {
 public:
  /// `theta_rad`: angle of the stick. Elements beyond the array's ends are missing.
  ElementSum(const hw::AcquisitionPlan& plan, double theta_rad);

  /// Adds the echo to samples at ranges (i + 1/2) * spacing_m, shifted by `delay_m`: the spectrum
  /// of the pulse (that of sim/beam/point_spread.h), sent, scattered and received, against the
  /// centre frequency's phase at range 0. Not normalised: a sum over sources of amplitude /
  /// distance.
  void add(const BeamPoint& point,
           double delay_m,
           double spacing_m,
           std::span<std::complex<double>> iq) const;

  /// Largest echo of a scatterer of amplitude 1 on the axis.
  double on_axis(double range_m) const;

  /// Sources that send and receive at a range, for an estimate of the cost of add().
  std::size_t sources(double range_m) const;

 private:
  struct Element {
    double axial_m;  ///< of its middle, in the image plane
    double lateral_m;
    double send_m;  ///< way from its middle to the transmit focus, less the focus's range
    double sends;   ///< share of it that lies within the transmitting aperture
  };
  /// One part of an element's length, over all of its height.
  struct Column {
    double axial_m;
    double lateral_m;
    std::size_t element;
  };
  struct Ways {
    std::vector<double> length_m;  ///< through the lens; sources of one element follow each other
    std::vector<double> weight;    ///< 1 / distance
    double shortest_m;
    double longest_m;
  };
  struct Band {
    std::vector<double> wavenumber_per_m;
    std::vector<double> power;  ///< of the pulse, sum 1
  };

  Ways ways_to(const glm::dvec3& point_m) const;
  Band band(double spread_m) const;
  /// Share of an element that lies within an aperture with its focus at a range.
  double within(const Element& element, double aperture_m, double range_m) const;
  double receives(const Element& element, double range_m) const;
  std::vector<std::complex<double>> element_spectra(const Ways& ways,
                                                    const Band& band,
                                                    double last_m) const;
  std::complex<double> sample(const std::vector<std::complex<double>>& spectra,
                              const std::vector<std::complex<double>>& sent,
                              const Band& band,
                              double range_m) const;

  double radius_m_;
  double pitch_m_;
  double transmit_focus_m_;
  double sigma_m_;  ///< of the pulse
  double wavenumber_per_m_;
  hw::AcquisitionPlan plan_;
  std::vector<Element> elements_;
  std::vector<Column> columns_;
  std::vector<double> heights_m_;  ///< of the point sources across the image plane
  std::vector<double> lens_m_;     ///< what the lens adds to the way of each
};

}  // namespace wobblebench::sim
