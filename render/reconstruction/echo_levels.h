// Levels of fluid and tissue in a volume of sticks: what a detector's threshold is measured by.
#pragma once

#include <vector>

#include "hw/probe/acquisition_plan.h"
#include "render/reconstruction/stick_span.h"

namespace wobblebench::render {

/// Mean samples of the two classes into which Otsu's threshold divides the volume of interest
/// (docs/references.md [23]). They follow the display's range, its gain and the noise, so that a
/// fraction of the way between them is a threshold for any of these.
struct EchoLevels {
  double fluid = 0;
  double tissue = 0;
  /// False where the samples are of one kind, noise alone say: then there is no surface.
  bool separate = false;

  double at(double fraction) const { return fluid + fraction * (tissue - fluid); }
};

/// Classes count as two if their means differ by this many standard deviations within a class.
/// Otsu's halves of one Gaussian differ by 2.65.
inline constexpr double kLeastSeparation = 3;

/// Samples are averaged over this range first: speckle would widen both classes.
inline constexpr double kLevelMean_m = 1e-3;

/// `frames`: samples in [0, 1], [line * samples_per_stick + sample]; `spans`: spans_in_box().
EchoLevels measure_levels(const hw::AcquisitionPlan& plan,
                          const std::vector<std::vector<float>>& frames,
                          const std::vector<SampleSpan>& spans);

}  // namespace wobblebench::render
