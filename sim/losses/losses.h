// Reflection at interfaces, absorption, and time-gain compensation (TGC).
#pragma once

#include <cmath>

#include "hw/probe/acquisition_plan.h"
#include "phantoms/material.h"
#include "sim/options.h"

namespace wobblebench::sim {

inline double amplitude_of_db(double db) {
  return std::pow(10.0, db / 20);
}

/// Amplitude reflection of a plane wave at an interface between fluids, by impedance and angle:
/// (Z2 cos i - Z1 cos t) / (Z2 cos i + Z1 cos t), sin t = (c2 / c1) sin i; 1 beyond the critical
/// angle. Shear waves in bone are not modelled.
double reflection(const phantoms::Material& before,
                  const phantoms::Material& behind,
                  double cos_incidence);

/// Diffuse fraction of an interface's echo, 0 to 1.
double roughness(const phantoms::Material& before, const phantoms::Material& behind);

/// Amplitude of an interface's echo relative to a perfect mirror, without losses on the way. |R| is
/// divided by roughness: the diffuse part is proportional to the cosine of incidence and becomes
/// speckle (this is its mean); the specular part has a narrow Gaussian lobe about the normal and
/// becomes one pulse.
double diffuse_echo(const phantoms::Material& before,
                    const phantoms::Material& behind,
                    double cos_incidence);
double specular_echo(const phantoms::Material& before,
                     const phantoms::Material& behind,
                     double cos_incidence,
                     const SimulationOptions& options);

/// Absorption there and back at the centre frequency, in nepers of amplitude for a metre of range.
double two_way_nepers_per_m(const hw::AcquisitionPlan& plan, double alpha_db_per_cm_mhz);

/// TGC at a range, as an amplitude factor.
double time_gain(const hw::AcquisitionPlan& plan, const SimulationOptions& options, double range_m);

/// Amplitude at the face below which an echo is invisible: 20 dB below the noise, or without noise
/// below the dynamic range. 0: every echo is visible.
double visible_amplitude(const hw::AcquisitionPlan& plan, const SimulationOptions& options);

}  // namespace wobblebench::sim
