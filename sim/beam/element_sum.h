// Echoes of point scatterers by direct summation over the probe's elements, in double precision:
// linear acoustics in a homogeneous medium, frequency by frequency, as in Field II.
#pragma once

#include <complex>
#include <cstddef>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "hw/probe/acquisition_plan.h"

namespace wobblebench::sim {

/// A point scatterer.
struct BeamPoint {
  glm::dvec3 at_m{0};  ///< beam coordinates: axial, lateral, elevation
  double amplitude = 1;
};

/// The probe's elements as used for one stick. They lie on the curved face, each divided into point
/// sources, three along the face and across it as many as keep them within half a wavelength. A
/// lens focuses each across the image plane. On transmit, delays focus at the transmit focus; on
/// receive, at each range (dynamic focus). An aperture subtends the F-number's angle at its focus,
/// so that it grows with the focus's range; elements partly within it are weighted by that share.
class ElementSum {
 public:
  /// `theta_rad`: angle of the stick. The aperture ends with the array.
  ElementSum(const hw::AcquisitionPlan& plan, double theta_rad);

  /// Adds the echo to IQ samples at ranges (i + 1/2) * spacing_m, delayed by `delay_m` of range.
  /// The pulse is that of sim/beam/point_spread.h, demodulated by the centre frequency with phase 0
  /// at range 0. Not normalised: a sum over sources of amplitude / distance.
  void add(const BeamPoint& point,
           double delay_m,
           double spacing_m,
           std::span<std::complex<double>> iq) const;

  /// Peak echo of a scatterer of amplitude 1 on the axis.
  double on_axis(double range_m) const;

  /// Number of point sources used on transmit and on receive at a range: the cost of add().
  std::size_t sources(double range_m) const;

 private:
  struct Element {
    double axial_m;  ///< of its middle, in the image plane
    double lateral_m;
    double transmit_path_m;  ///< from its middle to the transmit focus, less the focus's range
    double transmit_share;   ///< share of it within the transmit aperture
  };
  /// One of the strips along the face into which an element is divided, over its whole height.
  struct Column {
    double axial_m;
    double lateral_m;
    std::size_t element;
  };
  /// Acoustic paths from all sources to a point.
  struct Paths {
    std::vector<double> length_m;  ///< lens included; the sources of an element are consecutive
    std::vector<double> weight;    ///< 1 / distance
  };
  /// The pulse's spectrum.
  struct Band {
    std::vector<double> wavenumber_per_m;
    std::vector<double> power;  ///< sum 1
  };

  /// Ranges at which an echo can begin and end.
  struct Extent {
    double first_m;
    double last_m;
  };

  Paths paths_to(const glm::dvec3& point_m) const;
  Extent extent(const Paths& paths, double range_m) const;
  Band band(double spread_m) const;
  /// Share of an element within an aperture whose focus is at a range.
  double within(const Element& element, double aperture_m, double range_m) const;
  double receive_share(const Element& element, double range_m) const;
  std::vector<std::complex<double>> element_spectra(const Paths& paths,
                                                    const Band& band,
                                                    double last_m) const;
  std::vector<std::complex<double>> transmitted_spectrum(
      const std::vector<std::complex<double>>& spectra, const Band& band) const;
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
  std::vector<double> lens_m_;     ///< path that the lens adds to each
};

}  // namespace wobblebench::sim
