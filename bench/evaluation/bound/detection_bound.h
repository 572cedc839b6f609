// The least error of a surface's range that the echoes of a probe allow: what a detector reaches
// that knows tissue, noise, beam and incidence, and looks only for the surface's range on a stick.
// docs/decisions/0030-detection-bound.md says what is assumed and what is left out.
#pragma once

#include <glm/vec3.hpp>
#include <vector>

#include "base/units.h"
#include "bench/evaluation/bound/edge_signal.h"
#include "hw/probe/acquisition_plan.h"
#include "sim/optics/beam_profile.h"
#include "sim/options.h"

namespace wobblebench::bench {

/// Where a stick meets a plane surface, and how it is received. Echo powers are in dB re a perfect
/// mirror, as received: attenuated, before TGC. Defaults: soft tissue 70 mm from
/// the default probe.
struct DetectionConditions {
  double incidence_rad = 0;            ///< between stick and normal, 0 to kMostIncidence_rad
  double azimuth_rad = 0;              ///< of the slope: 0 in the image plane, 90 degrees across it
  double tissue_db = -44;              ///< mean echo power behind the surface
  double fluid_db = -200;              ///< before it: clutter that has the speckle of the probe
  double noise_db = -95;               ///< power of the white noise of each IQ sample
  double lateral_fwhm_m = 1.6e-3;      ///< two-way -6 dB widths, sim::BeamProfile
  double elevation_fwhm_m = 2.2e-3;    ///< across the image plane
  double pulse_fwhm_m = 0.32e-3;       ///< sim::axial_fwhm_m()
  double sample_spacing_m = 0.156e-3;  ///< of IQ samples
  double line_spacing_m = 2.3e-3;      ///< of neighbouring sticks at the surface's range …
  double frame_spacing_m = 2.9e-3;     ///< … and of frames
};

inline constexpr double kMostIncidence_rad = 80 * kDegree;

/// Throws std::invalid_argument "detection_bound_m: FIELD = VALUE: what is allowed".
void validate(const DetectionConditions& conditions);

/// Root mean square error (m, along the stick) that no unbiased detector falls below: the
/// Cramer-Rao bound from the complex samples of the stick and of those neighbours that lie within
/// half a beam's -6 dB width of it, where the surface is taken to be a plane. It holds for a plane
/// of known slope and, because the neighbours are symmetrical, of unknown slope too. The mean over
/// where the surface lies between two samples. Throws as validate().
double detection_bound_m(const DetectionConditions& conditions);

/// Sigma, along the stick, of the rise from fluid to tissue: pulse and the beam's footprint on the
/// slope.
double rise_sigma_m(const DetectionConditions& conditions);

/// Eigenvalues of the correlation of the speckle of the stick and its neighbours: the sticks whose
/// axes lie within half the beam's -6 dB width, along the line or across frames. Where all meet the
/// surface at the same range, their samples have the covariance C x S + N I (C: between sticks, S:
/// along one), and their information is the sum over the eigenvalues l of C of that of one stick
/// with echo l S. {1} where the sticks are farther apart. The correlation at a distance d is that
/// of a Gaussian beam of flat wave fronts, exp(-(d / 2 sigma)^2); curved ones out of focus
/// correlate less, so that neighbours within a beam width carry more information than this model
/// gives them.
std::vector<double> neighbour_modes(const DetectionConditions& conditions);

/// The samples of one stick as a random process, for a beam of Gaussian power. Powers are relative
/// to a perfect mirror's.
EdgeSignal edge_signal(const DetectionConditions& conditions);

/// Window of samples that holds all that tells of a surface at range 0: `count` samples from
/// `first_m` on.
struct SampleWindow {
  double first_m = 0;
  int count = 0;
};
SampleWindow sample_window(const DetectionConditions& conditions);

/// By how much a surface with this normal lies farther away for each metre across the stick, in the
/// image plane and across it. Beyond kMostIncidence_rad the slope of that incidence.
struct StickSlope {
  double lateral = 0;
  double elevation = 0;
};
StickSlope stick_slope(const hw::PolarPoint& point,
                       const hw::ProbeGeometry& geometry,
                       const glm::dvec3& normal);

/// Conditions of a surface with this unit normal at a point of the probe's field. Tissue and noise
/// are the simulator's; the beam's level towards the end of the array counts against the tissue.
/// `tissue_mean_db`: mean echo of the material (`Material::backscatter_db`).
DetectionConditions conditions_at(const hw::AcquisitionPlan& plan,
                                  const sim::BeamProfile& profile,
                                  const sim::SimulationOptions& options,
                                  const hw::PolarPoint& point,
                                  const glm::dvec3& normal,
                                  double tissue_mean_db);

}  // namespace wobblebench::bench
