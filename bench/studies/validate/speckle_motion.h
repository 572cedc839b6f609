// Whether speckle moves with the tissue.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "hw/probe/acquisition_plan.h"
#include "sim/options.h"

namespace wobblebench::bench {

struct SpeckleMotionInputs {
  int sticks = 48;  ///< in one frame
  int frames = 24;  ///< of the scan whose tissue turns about the motor's axis
  int samples = 512;
  int axial_shift = 8;  ///< samples that tissue moves along the axis
  std::uint64_t seed = 1;
};

/// Correlations of the envelope, between 45 and 85 mm from the face.
struct MotionResult {
  std::string motion;
  double shift_mm = 0;  ///< of tissue 75 mm from the face
  double followed = 0;  ///< with the envelope before, at the place that the tissue came from
  double stayed = 0;    ///< with the envelope before, at the same place
  long n = 0;           ///< samples
};

/// Tissue that moves along the axis by whole samples, turns in the image plane by one stick, or
/// turns about the motor's axis by one frame, from one look of a stick to the next. All are exact:
/// each stick sees what it, or its neighbour, saw one volume before.
std::vector<MotionResult> measure_speckle_motion(sim::Rung rung, const SpeckleMotionInputs& inputs);

}  // namespace wobblebench::bench
