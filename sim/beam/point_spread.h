// The probe's resolution: widths of its point spread (docs/references.md [4, 5]) and the kernels
// that give speckle that size on the polar grid.
#pragma once

#include <vector>

#include "hw/probe/acquisition_plan.h"

namespace wobblebench::sim {

/// Full width at half amplitude along the stick: (c/2) 0.8825 / (B f0), a Gaussian pulse.
double axial_fwhm_m(const hw::AcquisitionPlan& plan);
/// Apertures in the image plane: both follow the F-number, as far as there are elements. The
/// receiving one grows with the range that it listens to, the transmitting one is that of its
/// focus.
double receive_aperture_m(const hw::AcquisitionPlan& plan, double range_m);
double transmit_aperture_m(const hw::AcquisitionPlan& plan);
/// Two-way -6 dB width in the image plane: 0.886 lambda F# at the transmit focus, where both
/// apertures are focused, and a little more because elements look away from the stick at the
/// apertures' edges (1 + 2 q / 15, if the edge is heard with 1 - q of the middle's strength); away
/// from it the transmitted beam widens (diffraction and geometric width in quadrature) and the
/// receiving one, focused at every range, is left: at most 1.253 lambda F#.
double lateral_fwhm_m(const hw::AcquisitionPlan& plan, double range_m);
/// One-way width of the transmitted beam alone.
double transmit_fwhm_m(const hw::AcquisitionPlan& plan, double range_m);
/// Two-way width across the image plane: 0.886 lambda range / height at the fixed focus. Away from
/// it the aperture's shadow widens it as the Fresnel number of the defocus says, height^2 |1 /
/// range - 1 / focus| / 4 lambda: little below 0.6, and to three quarters of the shadow far away.
/// It is the width of the Gaussian whose power varies as much over the beam (equal (integral of
/// p)^2 / integral of p^2) as that of the diffracted beam in sim/beam/beam_pattern.h.
double elevation_fwhm_m(const hw::AcquisitionPlan& plan, double range_m);

/// Distance between neighbouring image planes at a place, (r cos(theta) - b) d phi; 0 for one
/// frame.
double frame_distance_m(const hw::AcquisitionPlan& plan, int line, double range_m);

/// sigma of the Gaussian of that width: FWHM / 2.3548.
double sigma_of_fwhm(double fwhm);

/// Samples of a Gaussian with sum of squares 1, so that filtered white noise keeps its power. Odd
/// count, cut where it falls below one percent, at most 2 * max_half + 1 taps.
std::vector<float> unit_power_gaussian(double sigma_in_steps, int max_half);

}  // namespace wobblebench::sim
