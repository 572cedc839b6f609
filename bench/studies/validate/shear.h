// Shear of moving tissue: each stick images it at the time of its firing.
#pragma once

#include <string>
#include <vector>

#include "bench/studies/validate/study_report.h"
#include "hw/probe/acquisition_plan.h"
#include "phantoms/motion.h"

namespace wobblebench::bench {

struct ShearInputs {
  int sticks = 64;
  int frames = 37;
  int samples = 4096;
};

/// Range of the front of a moving sphere on rung `geometry`, against the intersection of the stick
/// with a sphere whose centre is displaced in closed form for the stick's time. Sticks with an
/// angle of incidence below 60 degrees.
struct ShearResult {
  std::string motion;
  double largest_error_m = 0;
  double mean_error_m = 0;
  double largest_shear_m = 0;  ///< error of assuming a still sphere
  double allowed_m = 0;        ///< half a sample, and the rounding of the phantom's grid
  long n = 0;                  ///< sticks
  struct Middle {
    double time_s, found_m, expected_m, still_m;
  };
  std::vector<Middle> middle;  ///< the middle stick of each frame that meets the sphere
};

std::vector<ShearResult> measure_shear(const ShearInputs& inputs);

StudyReport shear_report();

}  // namespace wobblebench::bench
