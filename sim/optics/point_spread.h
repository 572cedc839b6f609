// The pulse and the apertures of the probe (docs/references.md [4, 5]).
#pragma once

#include <vector>

#include "hw/probe/acquisition_plan.h"

namespace wobblebench::sim {

/// Of the pulse's centre frequency.
double wavelength_m(const hw::AcquisitionPlan& plan);
/// Full width at half amplitude along the stick of a Gaussian pulse: (c/2) 0.8825 / (B f0).
double axial_fwhm_m(const hw::AcquisitionPlan& plan);
/// IQ samples for each output sample: enough for the two-sided bandwidth of the pulse.
int iq_oversampling(const hw::AcquisitionPlan& plan);
/// The transmit focus that serves a range.
double transmit_focus_m(const hw::AcquisitionPlan& plan, double range_m);
/// Aperture widths in the image plane by the F-number, limited by the number of elements. The
/// receive aperture grows with the range (dynamic focus), the transmit aperture is that of the
/// fixed focus that serves the range.
double receive_aperture_m(const hw::AcquisitionPlan& plan, double range_m);
double transmit_aperture_m(const hw::AcquisitionPlan& plan, double range_m);

/// Sigma of a Gaussian of this full width at half maximum: FWHM / 2.3548.
double sigma_of_fwhm(double fwhm);

/// Taps of a Gaussian filter with sum of squares 1, so that filtered white noise keeps its power.
/// Their number is odd, at most 2 * max_half + 1; taps below one percent of the peak are left out.
std::vector<float> unit_power_gaussian(double sigma_in_steps, int max_half);

}  // namespace wobblebench::sim
