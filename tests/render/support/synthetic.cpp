#include "tests/render/support/synthetic.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <glm/geometric.hpp>
#include <stdexcept>

#include "base/hash.h"

namespace wobblebench::render::testing {
namespace {

/// Uniform in [-1, 1].
double hash(const glm::dvec3& position, std::uint64_t seed) {
  std::uint64_t h = mix64(seed + kGoldenGamma);
  for (int axis = 0; axis < 3; ++axis) h = mix64(h ^ std::bit_cast<std::uint64_t>(position[axis]));
  return 2 * (unit_interval(h)) - 1;
}

}  // namespace

hw::PolarVolume sample_field(const hw::AcquisitionPlan& plan,
                             const Field& field,
                             std::uint32_t volume_index,
                             const MotorLaw& law) {
  hw::PolarVolume volume(plan, volume_index);
  const hw::ProbeGeometry geometry = plan.geometry();
  for (int i = 0; i < plan.sticks_per_volume(); ++i) {
    hw::Stick stick;
    stick.sequence = plan.first_sequence(volume_index) + static_cast<std::uint64_t>(i);
    stick.index = plan.index(stick.sequence);
    stick.motor_angle_rad = law ? law(stick.index) : plan.motor_angle_rad(stick.index);
    const double theta_rad = plan.theta_rad(static_cast<int>(stick.index.line));
    for (int k = 0; k < plan.acquisition().samples_per_stick; ++k) {
      const glm::dvec3 position =
          geometry.to_cartesian({plan.sample_range_m(k), theta_rad, stick.motor_angle_rad});
      stick.samples.push_back(static_cast<float>(field(position)));
    }
    volume.place(stick);
  }
  return volume;
}

double soft_step(double distance_m, double inside, double outside, double ramp_m) {
  if (ramp_m == 0) return distance_m <= 0 ? inside : outside;
  const double share = std::clamp(0.5 - distance_m / ramp_m, 0.0, 1.0);
  return std::lerp(outside, inside, share);
}

Field sphere(const glm::dvec3& center_m, double radius_m, double ramp_m) {
  return [=](const glm::dvec3& position) {
    return soft_step(glm::distance(position, center_m) - radius_m, kInside, kOutside, ramp_m);
  };
}

Field plane(const glm::dvec3& point_m, const glm::dvec3& normal, double ramp_m) {
  const glm::dvec3 unit = glm::normalize(normal);
  return [=](const glm::dvec3& position) {
    return soft_step(glm::dot(position - point_m, unit), kInside, kOutside, ramp_m);
  };
}

Field noisy(Field field, double amplitude, std::uint64_t seed) {
  return [=](const glm::dvec3& position) {
    return std::clamp(field(position) + amplitude * hash(position, seed), 0.0, 1.0);
  };
}

hw::AcquisitionPlan small_plan() {
  hw::AcquisitionOptions acquisition;
  acquisition.sticks_per_frame = 48;
  acquisition.samples_per_stick = 160;
  acquisition.frames_per_volume = 21;
  return {hw::ProbeOptions{}, acquisition};
}

RenderOptions small_options() {
  RenderOptions options;
  options.scan_conversion.slice_size = 128;
  options.ray_casting.image_size = 40;
  options.ray_casting.steps = 64;
  // The light of the golden sheet, whatever the defaults are.
  options.shading.light_up_rad = 25 * kDegree;
  options.shading.ambient = 0.15;
  options.shading.diffuse = 0.75;
  options.shading.specular = 0.2;
  options.shading.base_rgb = {0.96, 0.74, 0.55};
  options.shading.shadow_coefficient = 0.6;
  return options;
}

const hw::PolarVolume& noisy_scene() {
  static const hw::PolarVolume volume = [] {
    const Field ball = sphere({0.008, -0.006, 0.115}, 0.022, 4e-3);
    const Field wall = plane({0, 0, 0.140}, {0.2, -0.1, -1}, 4e-3);
    const Field both = [=](const glm::dvec3& p) { return std::max(ball(p), wall(p)); };
    return sample_field(small_plan(), noisy(both, 0.08, 1));
  }();
  return volume;
}

DepthDifference compare(const Image<float>& a, const Image<float>& b) {
  if (a.pixels.size() != b.pixels.size()) throw std::logic_error("pictures of different sizes");
  DepthDifference difference;
  double sum = 0;
  int changed = 0;
  for (std::size_t i = 0; i < a.pixels.size(); ++i) {
    const bool in_a = !std::isnan(a.pixels[i]), in_b = !std::isnan(b.pixels[i]);
    changed += in_a != in_b;
    if (!in_a || !in_b) continue;
    const double d = double(a.pixels[i]) - double(b.pixels[i]);
    sum += d * d;
    difference.largest_m = std::max(difference.largest_m, std::abs(d));
    ++difference.both;
  }
  difference.rms_m = difference.both ? std::sqrt(sum / difference.both) : 0;
  difference.changed_share = double(changed) / double(a.pixels.size());
  return difference;
}

ColorDifference compare(const Image<glm::vec3>& a, const Image<glm::vec3>& b, double tolerance) {
  if (a.pixels.size() != b.pixels.size()) throw std::logic_error("pictures of different sizes");
  ColorDifference difference;
  int failing = 0;
  for (std::size_t i = 0; i < a.pixels.size(); ++i) {
    double largest = 0;
    for (int c = 0; c < 3; ++c) {
      const double d = std::abs(double(a.pixels[i][c]) - double(b.pixels[i][c]));
      largest = std::isnan(d) ? 1e30 : std::max(largest, d);
    }
    failing += largest > tolerance;
    difference.largest = std::max(difference.largest, largest);
  }
  difference.failing_share = double(failing) / double(a.pixels.size());
  return difference;
}

int hits(const Image<float>& depth_m) {
  return static_cast<int>(std::count_if(
      depth_m.pixels.begin(), depth_m.pixels.end(), [](float z) { return !std::isnan(z); }));
}

}  // namespace wobblebench::render::testing
