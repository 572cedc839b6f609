// The probe's response across the beam, from diffraction at its rectangular apertures
// (references.md [16]): what the closed forms of sim/beam/point_spread.h leave out.
#pragma once

#include <complex>

#include "hw/probe/acquisition_plan.h"

namespace wobblebench::sim {

/// A line of sources as one way uses it.
struct Aperture {
  double width_m;
  double focus_m;
  /// Turn of phase from an element's middle to its edge, for each metre that the element lies from
  /// the aperture's middle: the sources have the strength sinc(turn * place / pi). 0: all the same.
  double element_turn_per_m = 0;
};

/// Mean over the sources of the phase at a place `range_m` ahead and `offset_m` aside, against the
/// way along the axis, in the Fresnel approximation: exp(-i k ((x - u)^2 / 2 r - x^2 / 2 F)). 1 on
/// the axis at the focus, if all have the same strength.
std::complex<double> aperture_response(const Aperture& aperture,
                                       double wavenumber_per_m,
                                       double range_m,
                                       double offset_m);

/// Two-way responses at one frequency. In the image plane: sent with a fixed focus, received with a
/// focus at the range itself, by elements that lie on the curved face and look away from the stick
/// at the aperture's edges. Across it: the same fixed focus both ways.
std::complex<double> lateral_response(const hw::AcquisitionPlan& plan,
                                      double frequency_hz,
                                      double range_m,
                                      double offset_m);
std::complex<double> elevation_response(const hw::AcquisitionPlan& plan,
                                        double frequency_hz,
                                        double range_m,
                                        double offset_m);

}  // namespace wobblebench::sim
