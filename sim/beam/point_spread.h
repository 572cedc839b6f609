// The probe's resolution: widths of its point spread function (docs/references.md [4, 5]), and the
// kernels that give speckle this size on the polar grid.
#pragma once

#include <vector>

#include "hw/probe/acquisition_plan.h"

namespace wobblebench::sim {

/// Full width at half amplitude along the stick of a Gaussian pulse: (c/2) 0.8825 / (B f0).
double axial_fwhm_m(const hw::AcquisitionPlan& plan);
/// IQ samples for each output sample: enough for the two-sided bandwidth of the pulse.
int iq_oversampling(const hw::AcquisitionPlan& plan);
/// Aperture widths in the image plane by the F-number, limited by the number of elements. The
/// receive aperture grows with the range (dynamic focus), the transmit aperture is that of its
/// fixed focus.
double receive_aperture_m(const hw::AcquisitionPlan& plan, double range_m);
double transmit_aperture_m(const hw::AcquisitionPlan& plan);
/// Two-way -6 dB width in the image plane. At the transmit focus, where both apertures are focused:
/// 0.886 lambda F#, times 1 + 2 q / 15 for the elements' directivity, where 1 - q is the
/// sensitivity of an element at the aperture's edge relative to its middle. Away from it the
/// transmit beam widens (diffraction and geometric width in quadrature), and the width tends to
/// that of the receive beam, which is focused at every range: at most 1.253 lambda F#.
double lateral_fwhm_m(const hw::AcquisitionPlan& plan, double range_m);
/// One-way width of the transmit beam.
double transmit_fwhm_m(const hw::AcquisitionPlan& plan, double range_m);
/// Two-way width across the image plane: 0.886 lambda range / height at the fixed focus. Away from
/// it the width is a function of the Fresnel number of the defocus, height^2 |1 / range - 1 /
/// focus| / 4 lambda: little wider below 0.6, and three quarters of the aperture's geometric shadow
/// far away. It is the width of the Gaussian that has the same (integral of p)^2 / integral of p^2,
/// p the power over the beam, as the diffracted beam of sim/beam/beam_pattern.h.
double elevation_fwhm_m(const hw::AcquisitionPlan& plan, double range_m);

/// Distance between neighbouring image planes at a sample, (r cos(theta) - b) d phi; 0 for one
/// frame.
double frame_distance_m(const hw::AcquisitionPlan& plan, int line, double range_m);

/// Sigma of a Gaussian of this full width at half maximum: FWHM / 2.3548.
double sigma_of_fwhm(double fwhm);

/// Taps of a Gaussian filter with sum of squares 1, so that filtered white noise keeps its power.
/// Their number is odd, at most 2 * max_half + 1; taps below one percent of the peak are left out.
std::vector<float> unit_power_gaussian(double sigma_in_steps, int max_half);

}  // namespace wobblebench::sim
