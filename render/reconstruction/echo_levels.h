// Samples of the sticks in the volume of interest, and the levels of fluid and tissue among them:
// what a detector's threshold is measured by.
#pragma once

#include <vector>

#include "hw/probe/acquisition_plan.h"
#include "render/options.h"
#include "render/reconstruction/motor_angles.h"

namespace wobblebench::render {

/// Samples [begin, end) of a stick.
struct SampleSpan {
  int begin = 0, end = 0;
};

/// [frame * lines + line]. A motor that turns during a frame as planned is taken at the frame's
/// centre.
std::vector<SampleSpan> spans_in_box(const hw::AcquisitionPlan& plan,
                                     const VolumeOfInterest& box,
                                     const MotorAngles& angles = {});

/// Means over windows of a stick's samples, from prefix sums: each costs the same at any length.
class WindowMeans {
 public:
  explicit WindowMeans(const float* samples, int count);

  /// Over the samples [begin, end) that exist; 0 where none does.
  double mean(int begin, int end) const;

 private:
  std::vector<double> sums_;
};

/// Whole samples in a length, at least one.
int samples_in(double length_m, const hw::AcquisitionPlan& plan);

/// Mean samples of the two classes into which Otsu's threshold divides the volume of interest
/// (docs/references.md [23]). They follow the display's range, its gain and the noise, so that a
/// fraction of the way between them is a threshold for any of these.
struct EchoLevels {
  double fluid = 0;
  double tissue = 0;
  /// False where the samples are of one kind, noise alone say: then there is no surface.
  bool separate = false;
  double white = 0;  ///< samples at the display's upper end, over the number of those of tissue

  double at(double fraction) const { return fluid + fraction * (tissue - fluid); }
};

/// Classes count as two if their means differ by this many standard deviations within a class.
/// Otsu's halves of one Gaussian differ by 2.65.
inline constexpr double kLeastSeparation = 3;

/// A sample is white from here on: the last of 255 steps.
inline constexpr float kWhite = 254.5f / 255;

/// Samples are averaged over this range first: speckle would widen both classes.
inline constexpr double kLevelMean_m = 1e-3;

/// `frames`: samples in [0, 1], [line * samples_per_stick + sample]; `spans`: spans_in_box().
EchoLevels measure_levels(const hw::AcquisitionPlan& plan,
                          const std::vector<std::vector<float>>& frames,
                          const std::vector<SampleSpan>& spans);

}  // namespace wobblebench::render
