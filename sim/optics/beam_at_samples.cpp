#include "sim/optics/beam_at_samples.h"

#include <algorithm>
#include <cmath>

#include "sim/optics/point_spread.h"

namespace wobblebench::sim {

namespace {

constexpr double kAngleStep_rad = 1 * kDegree;
constexpr double kRangeStep_m = 1e-3;  // between ranges that are looked up

float squared(double x) {
  return static_cast<float>(x * x);
}

float mixed(float a, float b, float share) {
  return a + share * (b - a);
}

}  // namespace

double power_sigma(double amplitude_fwhm) {
  return sigma_of_fwhm(amplitude_fwhm) / std::sqrt(2.0);
}

BeamAtSamples::BeamAtSamples(const hw::AcquisitionPlan& plan,
                             const BeamProfile& profile,
                             double spacing_m,
                             int samples)
    : samples_(samples) {
  const int last = plan.acquisition().sticks_per_frame - 1;
  const double farthest = std::max(std::abs(plan.theta_rad(0)), std::abs(plan.theta_rad(last)));
  angles_ = 1 + static_cast<int>(std::ceil(farthest / kAngleStep_rad));
  angle_step_rad_ = angles_ > 1 ? farthest / (angles_ - 1) : 1;
  const int stride = std::max(1, static_cast<int>(kRangeStep_m / spacing_m));
  for (int a = 0; a < angles_; ++a) {
    const auto look_up = [&](int sample) {
      const double range_m = (sample + 0.5) * spacing_m, theta = a * angle_step_rad_;
      const double level = profile.level(range_m, theta);
      return BeamAtSample{squared(power_sigma(profile.lateral_fwhm_m(range_m, theta))),
                          squared(power_sigma(profile.elevation_fwhm_m(range_m))),
                          squared(level)};
    };
    BeamAtSample from = look_up(0), to = look_up(stride);
    for (int i = 0; i < samples; ++i) {
      if (i > 0 && i % stride == 0) {
        from = to;
        to = look_up(i + stride);
      }
      const float share = static_cast<float>(i % stride) / static_cast<float>(stride);
      table_.push_back({mixed(from.lateral2, to.lateral2, share),
                        mixed(from.elevation2, to.elevation2, share),
                        mixed(from.level2, to.level2, share)});
    }
  }
}

const BeamAtSample* BeamAtSamples::of(double theta_rad) const {
  const double steps = std::round(std::abs(theta_rad) / angle_step_rad_);
  const auto angle = static_cast<std::size_t>(std::min(steps, angles_ - 1.0));
  return table_.data() + angle * static_cast<std::size_t>(samples_);
}

}  // namespace wobblebench::sim
