// The probe's response across the beam by Fresnel diffraction at its rectangular apertures
// (docs/references.md [16]), phase and side lobes included; point_spread.h has closed forms of
// widths.
#pragma once

#include <complex>

#include "hw/probe/acquisition_plan.h"

namespace wobblebench::sim {

/// A line aperture, on transmit or on receive.
struct Aperture {
  double width_m;
  double focus_m;
  /// Directivity of its elements: difference of phase between an element's middle and its edge, for
  /// each metre from the aperture's middle. A source at x has the strength sinc(phase * x / pi);
  /// with 0 all are equal.
  double element_phase_per_m = 0;
};

/// Mean over the sources at x of the phasor at range r = `range_m` and lateral offset u =
/// `offset_m`, relative to the path along the axis, in the Fresnel approximation: exp(-i k ((x -
/// u)^2 / 2 r - x^2 / 2 F)). 1 on the axis at the focus, if all sources are equal.
std::complex<double> aperture_response(const Aperture& aperture,
                                       double wavenumber_per_m,
                                       double range_m,
                                       double offset_m);

/// Two-way responses at one frequency. In the image plane: fixed transmit focus, dynamic receive
/// focus, with the directivity of elements on the curved face. Across it: the lens's fixed focus on
/// transmit and on receive.
std::complex<double> lateral_response(const hw::AcquisitionPlan& plan,
                                      double frequency_hz,
                                      double range_m,
                                      double offset_m);
std::complex<double> elevation_response(const hw::AcquisitionPlan& plan,
                                        double frequency_hz,
                                        double range_m,
                                        double offset_m);

}  // namespace wobblebench::sim
