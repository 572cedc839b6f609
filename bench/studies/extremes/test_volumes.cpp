#include "bench/studies/extremes/test_volumes.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <stdexcept>

#include "base/hash.h"
#include "render/camera.h"
#include "render/reconstruction/reconstruction.h"
#include "render/reference/reference_passes.h"

namespace wobblebench::bench {

namespace {

constexpr double kMiddle = 0.55, kRadius = 0.25, kRamp = 0.1;  // of the depth
constexpr double kInside = 0.9, kOutside = 0.1, kNoiseLevel = 0.05;

/// Uniform in [-1, 1], of an index.
double noise(std::uint64_t index) {
  return 2 * unit_interval(mix64(index + kGoldenGamma)) - 1;
}

double ball(const glm::dvec3& position_m, const hw::AcquisitionPlan& plan) {
  const double depth_m = plan.acquisition().depth_m;
  const glm::dvec3 center =
      plan.geometry().to_cartesian({.range_m = kMiddle * depth_m, .theta_rad = 0, .phi_rad = 0});
  const double outside_m = glm::distance(position_m, center) - kRadius * depth_m;
  return std::lerp(kOutside, kInside, std::clamp(0.5 - outside_m / (kRamp * depth_m), 0.0, 1.0));
}

/// Calls visit(stick with its samples) for every stick of the plan.
template <class SampleOf>
hw::PolarVolume made(const hw::AcquisitionPlan& plan, const SampleOf& sample_of) {
  hw::PolarVolume volume(plan);
  const int length = plan.acquisition().samples_per_stick;
  for (int i = 0; i < plan.sticks_per_volume(); ++i) {
    hw::Stick stick;
    stick.sequence = static_cast<std::uint64_t>(i);
    stick.index = plan.index(stick.sequence);
    stick.motor_angle_rad = plan.motor_angle_rad(stick.index);
    for (int k = 0; k < length; ++k) stick.samples.push_back(sample_of(stick, k));
    volume.place(stick);
  }
  return volume;
}

float sample_of(const hw::PolarVolume& volume, const hw::Stick& stick, int k) {
  const auto length = static_cast<std::size_t>(volume.plan().acquisition().samples_per_stick);
  return volume.frame(static_cast<int>(stick.index.frame))
      .samples[stick.index.line * length + static_cast<std::size_t>(k)];
}

struct Change {
  bool all = false;
  float given = 0, meant = 0;
};

Change of(SampleChange change) {
  using Limits = std::numeric_limits<float>;
  switch (change) {
    case SampleChange::all_zero:
      return {true, 0, 0};
    case SampleChange::all_one:
      return {true, 1, 1};
    case SampleChange::one_nan:
      return {false, Limits::quiet_NaN(), 0};
    case SampleChange::one_infinity:
      return {false, Limits::infinity(), 0};
    case SampleChange::one_minus_infinity:
      return {false, -Limits::infinity(), 0};
    case SampleChange::one_denormal:
      return {false, Limits::denorm_min(), 0};
    case SampleChange::one_1e30:
      return {false, 1e30F, 1};
    case SampleChange::none:
      break;
  }
  throw std::logic_error("no change");
}

}  // namespace

hw::PolarVolume ball_volume(const hw::AcquisitionPlan& plan) {
  const hw::ProbeGeometry geometry = plan.geometry();
  const auto length = static_cast<std::uint64_t>(plan.acquisition().samples_per_stick);
  return made(plan, [&](const hw::Stick& stick, int k) {
    const double theta_rad = plan.theta_rad(static_cast<int>(stick.index.line));
    const glm::dvec3 position =
        geometry.to_cartesian({plan.sample_range_m(k), theta_rad, stick.motor_angle_rad});
    const double value = ball(position, plan) + kNoiseLevel * noise(stick.sequence * length +
                                                                    static_cast<std::uint64_t>(k));
    return static_cast<float>(value);
  });
}

ChangedVolume changed_volume(const hw::PolarVolume& volume, SampleChange change) {
  if (change == SampleChange::none) return {volume, volume};
  const hw::AcquisitionPlan& plan = volume.plan();
  const double range_m = (kMiddle - kRadius) * plan.acquisition().depth_m;
  const hw::StickIndex changed_stick =
      plan.nearest_stick({.range_m = range_m, .theta_rad = 0, .phi_rad = 0}, 0);
  const int changed_sample = static_cast<int>(range_m / plan.sample_spacing_m());
  const Change to = of(change);
  const auto with = [&](float value) {
    return made(plan, [&](const hw::Stick& stick, int k) {
      const bool changed = to.all || (stick.index == changed_stick && k == changed_sample);
      return changed ? value : sample_of(volume, stick, k);
    });
  };
  return {with(to.given), with(to.meant)};
}

std::vector<bool> reached_pixels(const hw::PolarVolume& before,
                                 const hw::PolarVolume& after,
                                 const render::RenderOptions& options) {
  const render::reference::SliceStack one(before, options), other(after, options);
  const double same = needs_levels(options) ? 1e-3 : 0;
  const auto differs = [&](const hw::Ray& ray) {
    const render::Span span = clip_to_box(ray, options.volume_of_interest);
    const double part_m = 0.25 * step_m(options);
    const int parts = static_cast<int>(std::floor((span.to_m - span.from_m) / part_m));
    for (int part = 0; part <= parts; ++part) {
      const glm::dvec3 position = ray.at(span.from_m + part * part_m);
      if (std::abs(one.at(position).value - other.at(position).value) > same) return true;
    }
    return false;
  };
  const render::Camera camera = make_camera(options);
  std::vector<bool> reached;
  for (int row = 0; row < camera.image_size; ++row) {
    for (int column = 0; column < camera.image_size; ++column) {
      const auto beside = [&](double right, double down) {
        return differs(camera.ray(column + right, row + down));
      };
      reached.push_back(beside(0, 0) || beside(-0.25, 0) || beside(0.25, 0) || beside(0, -0.25) ||
                        beside(0, 0.25));
    }
  }
  return reached;
}

long changed_out_of_reach(const std::vector<bool>& reached,
                          const Image<float>& before_m,
                          const Image<float>& after_m,
                          const render::RenderOptions& options) {
  const double allowed_m = needs_levels(options) ? 0.01 * step_m(options) : 0;
  long changed = 0;
  for (std::size_t i = 0; i < reached.size(); ++i) {
    const double before = before_m.pixels[i], after = after_m.pixels[i];
    if (reached[i] || (std::isnan(before) && std::isnan(after))) continue;
    if (!(std::abs(after - before) <= allowed_m)) ++changed;
  }
  return changed;
}

}  // namespace wobblebench::bench
