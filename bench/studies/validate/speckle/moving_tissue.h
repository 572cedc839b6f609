// Tissue that moves during a scan: its shear, as each stick images it at the time of its firing,
// and the correlation of speckle before and after the tissue has moved.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "bench/studies/validate/common/study_report.h"
#include "hw/probe/acquisition_plan.h"
#include "phantoms/motion.h"
#include "sim/options.h"

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
