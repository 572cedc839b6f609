#include "render/reconstruction/stick_span.h"

#include <algorithm>
#include <cmath>

#include "render/camera.h"

namespace wobblebench::render {

std::vector<SampleSpan> spans_in_box(const hw::AcquisitionPlan& plan, const VolumeOfInterest& box) {
  const hw::ProbeGeometry geometry = plan.geometry();
  const hw::AcquisitionOptions& scan = plan.acquisition();
  const double spacing_m = plan.sample_spacing_m();
  std::vector<SampleSpan> spans;
  for (int frame = 0; frame < scan.frames_per_volume; ++frame) {
    for (int line = 0; line < scan.sticks_per_frame; ++line) {
      const hw::Ray axis = geometry.stick(plan.theta_rad(line), plan.frame_phi_rad(frame));
      const Span inside = clip_to_box(axis, box);
      // Sample k lies at (k + 1/2) spacings.
      const auto first_from = [&](double range_m) {
        const double sample = std::ceil(range_m / spacing_m - 0.5);
        return static_cast<int>(std::clamp(sample, 0.0, double(scan.samples_per_stick)));
      };
      const bool misses = inside.to_m < inside.from_m;
      spans.push_back(misses ? SampleSpan{}
                             : SampleSpan{first_from(inside.from_m), first_from(inside.to_m)});
    }
  }
  return spans;
}

WindowMeans::WindowMeans(const float* samples, int count) {
  sums_.reserve(static_cast<std::size_t>(count) + 1);
  sums_.push_back(0);
  for (int k = 0; k < count; ++k) sums_.push_back(sums_.back() + static_cast<double>(samples[k]));
}

double WindowMeans::mean(int begin, int end) const {
  const int count = static_cast<int>(sums_.size()) - 1;
  begin = std::clamp(begin, 0, count);
  end = std::clamp(end, 0, count);
  if (end <= begin) return 0;
  const double sum = sums_[static_cast<std::size_t>(end)] - sums_[static_cast<std::size_t>(begin)];
  return sum / (end - begin);
}

int samples_in(double length_m, const hw::AcquisitionPlan& plan) {
  return std::max(1, static_cast<int>(std::lround(length_m / plan.sample_spacing_m())));
}

}  // namespace wobblebench::render
