#include "render/geometry/dense_plan.h"

#include <algorithm>
#include <cmath>

namespace wobblebench::render {
namespace {

/// At least one step between `count` sticks `spacing_m` apart.
int steps_for(double spacing_m, double wanted_m, int count) {
  constexpr int kMostSteps = 8, kMostSticks = 1024;
  if (count < 2) return 1;
  const int most = std::clamp((kMostSticks - 1) / (count - 1), 1, kMostSteps);
  return std::clamp(static_cast<int>(std::ceil(spacing_m / wanted_m - 1e-9)), 1, most);
}

}  // namespace

DenseFactors dense_factors(const hw::AcquisitionPlan& plan, const RenderOptions& options) {
  if (options.reconstruction.sticks == Sticks::plain) return {};
  const hw::ProbeGeometry geometry = plan.geometry();
  const hw::AcquisitionOptions& scan = plan.acquisition();
  const VolumeOfInterest& box = options.volume_of_interest;
  const double far_m =
      std::clamp(box.center_m.z + 0.5 * box.size_m.z, 0.0, geometry.radius_m() + scan.depth_m);
  const double wanted_m = options.reconstruction.spacing_m;
  return {
      steps_for(far_m * plan.theta_step_rad(), wanted_m, scan.sticks_per_frame),
      steps_for(
          (far_m - geometry.axis_z_m()) * plan.phi_step_rad(), wanted_m, scan.frames_per_volume)};
}

hw::AcquisitionPlan dense_plan(const hw::AcquisitionPlan& plan, const DenseFactors& factors) {
  hw::AcquisitionOptions scan = plan.acquisition();
  scan.sticks_per_frame = (scan.sticks_per_frame - 1) * factors.lines + 1;
  scan.frames_per_volume = (scan.frames_per_volume - 1) * factors.frames + 1;
  return {plan.probe(), scan};
}

}  // namespace wobblebench::render
