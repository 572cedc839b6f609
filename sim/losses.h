// What a stick loses on its way, what interfaces send back, and what time gain restores.
#pragma once

#include <cmath>
#include <vector>

#include "hw/acquisition_plan.h"
#include "phantoms/material.h"
#include "sim/options.h"
#include "sim/tissue_sampler.h"

namespace wobblebench::sim {

inline double amplitude_of_db(double db) {
  return std::pow(10.0, db / 20);
}

/// Amplitude reflection coefficient at normal incidence, (Z2 - Z1) / (Z2 + Z1).
double reflection(const phantoms::Material& before, const phantoms::Material& behind);

/// Two-way amplitude left at each sample: attenuation 2 alpha f d, and 1 - R^2 for each interface
/// crossed there and back.
std::vector<float> two_way_amplitude(const TissueProfile& profile,
                                     const std::vector<phantoms::Material>& materials,
                                     const hw::AcquisitionPlan& plan,
                                     const SimulationOptions& options,
                                     double spacing_m,
                                     int count);

/// Echo of an interface as amplitude against a perfect mirror, before losses on the way. The two
/// parts of |R|: a Gaussian specular lobe about the normal, which arrives as one pulse, and by
/// roughness a diffuse part that falls as the cosine of incidence and arrives as speckle (its
/// mean).
struct InterfaceEcho {
  double specular = 0;
  double diffuse = 0;
};
InterfaceEcho interface_echo(const Interface& interface,
                             const std::vector<phantoms::Material>& materials,
                             const SimulationOptions& options);

/// Time gain at a range, as an amplitude factor.
double time_gain(const hw::AcquisitionPlan& plan, const SimulationOptions& options, double range_m);

}  // namespace wobblebench::sim
