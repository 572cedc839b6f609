// Echoes of point scatterers by direct summation over the probe's elements, in double precision:
// linear acoustics in a homogeneous medium, frequency by frequency, as in Field II.
#pragma once

#include <complex>
#include <cstddef>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "sim/optics/probe_optics.h"

namespace wobblebench::sim {

/// A point scatterer.
struct BeamPoint {
  glm::dvec3 at_m{0};  ///< beam coordinates: axial, lateral, elevation
  double amplitude = 1;
  double frequency_ratio = 1;  ///< as for PulseBand::pulses()
};

/// The probe's elements as one stick uses them (StickAperture), each divided into point sources:
/// three or more along the face, and those of the lens across it. On transmit, delays focus at the
/// transmit focus; on receive, at each range (dynamic focus).
class ElementSum {
 public:
  /// `theta_rad`: angle of the stick.
  ElementSum(const ProbeOptics& optics, double theta_rad);

  /// Adds the echo to IQ samples at ranges (i + 1/2) * spacing_m, delayed by `delay_m` of range.
  /// The pulse is Gaussian, demodulated by the centre frequency with phase
  /// 0 at range 0. Not normalised: a sum over sources of amplitude / distance.
  void add(const BeamPoint& point,
           double delay_m,
           double spacing_m,
           std::span<std::complex<double>> iq) const;

  /// Peak echo of a scatterer of amplitude 1 on the axis.
  double on_axis(double range_m) const;

  /// Number of point sources used on transmit and on receive at a range: the cost of add().
  std::size_t sources(double range_m) const;

 private:
  /// One of the strips into which an element is divided along the face, over its whole height.
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
    std::vector<double> amplitude;  ///< sum 1
  };

  /// Ranges at which an echo can begin and end.
  struct Extent {
    double first_m;
    double last_m;
  };

  std::size_t sources_per_element() const {
    return static_cast<std::size_t>(columns_per_element_) * optics_.lens().height_m.size();
  }
  Paths paths_to(const glm::dvec3& point_m) const;
  Extent extent(const Paths& paths, double range_m) const;
  Band band(double spread_m, double frequency_ratio) const;
  std::vector<std::complex<double>> element_spectra(const Paths& paths,
                                                    const Band& band,
                                                    double range_m,
                                                    double last_m) const;
  std::vector<std::complex<double>> transmitted_spectrum(
      const std::vector<std::complex<double>>& spectra, const Band& band, double range_m) const;
  std::complex<double> sample(const std::vector<std::complex<double>>& spectra,
                              const std::vector<std::complex<double>>& sent,
                              const Band& band,
                              double range_m) const;

  double sigma_m_;  ///< of the pulse
  double wavenumber_per_m_;
  ProbeOptics optics_;
  StickAperture aperture_;
  int columns_per_element_;
  std::vector<Column> columns_;
};

}  // namespace wobblebench::sim
