// Correlation of speckle before and after its tissue has moved.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "bench/studies/validate/study_report.h"
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
  double followed = 0;  ///< with the previous envelope at the tissue's previous position
  double stayed = 0;    ///< with the previous envelope at the same position
  long n = 0;           ///< samples
};

/// Tissue that moves along the axis by whole samples, rotates in the image plane by one stick, or
/// rotates about the motor's axis by one frame between two volumes. All are exact: each stick scans
/// the tissue that it, or its neighbour, scanned one volume before.
std::vector<MotionResult> measure_speckle_motion(sim::Rung rung, const SpeckleMotionInputs& inputs);

StudyReport speckle_motion_report();

}  // namespace wobblebench::bench
