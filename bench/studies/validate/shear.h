// A volume takes time: what moves is seen by each stick where it is then.
#pragma once

#include <string>
#include <vector>

#include "hw/probe/acquisition_plan.h"
#include "phantoms/motion.h"

namespace wobblebench::bench {

struct ShearInputs {
  int sticks = 64;
  int frames = 37;
  int samples = 4096;
};

/// A sphere's front as the rung `geometry` shows it, against where a line meets a ball whose centre
/// is where the motion has it at the stick's time. Sticks that meet it at less than 60 degrees.
struct ShearResult {
  std::string motion;
  double largest_error_m = 0;
  double mean_error_m = 0;
  double largest_shear_m = 0;  ///< by how much a still sphere would be wrong
  double allowed_m = 0;        ///< half a sample, and what the phantom's grid rounds
  long n = 0;                  ///< sticks
  struct Middle {
    double time_s, found_m, expected_m, still_m;
  };
  std::vector<Middle> middle;  ///< the middle stick of each frame that meets the sphere
};

std::vector<ShearResult> measure_shear(const ShearInputs& inputs);

}  // namespace wobblebench::bench
