// The samples of each stick that lie in the volume of interest.
#pragma once

#include <vector>

#include "hw/probe/acquisition_plan.h"
#include "render/options.h"

namespace wobblebench::render {

/// Samples [begin, end) of a stick.
struct SampleSpan {
  int begin = 0, end = 0;
};

/// [frame * lines + line]. A motor that turns during a frame is taken at the frame's centre.
std::vector<SampleSpan> spans_in_box(const hw::AcquisitionPlan& plan, const VolumeOfInterest& box);

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

}  // namespace wobblebench::render
