// Echo of an interface over the angle of incidence.
#pragma once

#include <cstdint>
#include <vector>

#include "bench/studies/validate/common/statistics.h"
#include "bench/studies/validate/common/study_report.h"
#include "hw/probe/acquisition_plan.h"
#include "phantoms/material.h"
#include "sim/options.h"

namespace wobblebench::bench {

struct ReflectionInputs {
  std::vector<double> lobe_deg = {0, 0.5, 1, 1.5, 2, 2.5, 3, 4, 5, 6};
  std::vector<double> fresnel_deg = {0, 4, 8, 12, 16, 20, 23, 25, 26, 28, 32, 36, 40};
  double diffuse_bin_deg = 4;
  std::vector<std::uint64_t> seeds = seeds_from(1, 3);
  int sticks = 48;  ///< of the volume for the diffuse part
  int frames = 32;
};

/// Amplitude reflection of a plane wave between fluids (docs/references.md [12] has the figures):
/// (Z2 cos i - Z1 cos t) / (Z2 cos i + Z1 cos t) with sin t = (c2 / c1) sin i; 1 beyond the
/// critical angle.
double fresnel(const phantoms::Material& before,
               const phantoms::Material& behind,
               double angle_rad);

struct AnglePoint {
  double angle_rad = 0;
  double measured = 0;
  double expected = 0;
  long n = 0;
};

/// A smooth, tilted plane of soft tissue: largest echo of the stick on the axis, against |R| times
/// the Gaussian lobe of the default width.
std::vector<AnglePoint> measure_lobe(const ReflectionInputs& inputs);
/// A smooth plane of bone: the same with the widest lobe allowed, divided by that lobe, against
/// |R|.
std::vector<AnglePoint> measure_fresnel(const ReflectionInputs& inputs);
/// A rough plane scanned by a whole volume: echo energy per stick, in bins of the angle, as the
/// mean amplitude of an echo as long as the pulse; against |R| cos i.
std::vector<AnglePoint> measure_diffuse(sim::Rung rung, const ReflectionInputs& inputs);

StudyReport reflection_report();

}  // namespace wobblebench::bench
