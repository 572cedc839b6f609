#include "sim/clutter/particles.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "sim/math/random.h"
#include "sim/math/smooth_noise.h"

namespace wobblebench::sim {

namespace {

/// Beyond the field on all sides.
constexpr double kMargin_m = 10e-3;

phantoms::Box field_box(const hw::AcquisitionPlan& plan) {
  const hw::ProbeGeometry geometry = plan.geometry();
  const auto& acquisition = plan.acquisition();
  phantoms::Box box{glm::dvec3(HUGE_VAL), glm::dvec3(-HUGE_VAL)};
  const auto frames = static_cast<std::uint32_t>(acquisition.frames_per_volume);
  const auto lines = static_cast<std::uint32_t>(acquisition.sticks_per_frame);
  for (std::uint32_t frame = 0; frame < frames; ++frame) {
    for (std::uint32_t line = 0; line < lines; ++line) {
      const hw::Ray ray = stick_ray(plan, geometry, {0, frame, line}).ray;
      for (const double range_m : {0.0, acquisition.depth_m}) {
        const glm::dvec3 end = ray.origin + range_m * ray.direction;
        box.low = glm::min(box.low, end - kMargin_m);
        box.high = glm::max(box.high, end + kMargin_m);
      }
    }
  }
  return box;
}

/// With the margin about it.
bool in_field(const hw::AcquisitionPlan& plan,
              const hw::ProbeGeometry& geometry,
              const glm::dvec3& probe_m) {
  const hw::PolarPoint at = geometry.to_polar(probe_m);
  const auto& acquisition = plan.acquisition();
  const double margin_rad = kMargin_m / std::max(at.range_m + plan.probe().radius_m, kMargin_m);
  return at.range_m > -kMargin_m && at.range_m < acquisition.depth_m + kMargin_m &&
         std::abs(at.theta_rad) < 0.5 * acquisition.sector_rad + margin_rad &&
         std::abs(at.phi_rad) < 0.5 * acquisition.fan_rad + margin_rad;
}

}  // namespace

phantoms::PointScatterers fluid_particles(const phantoms::PlacedPhantom& subject,
                                          const TissueMap& map,
                                          const hw::AcquisitionPlan& plan,
                                          const SimulationOptions& options) {
  constexpr double kCubicCentimetre = 1e-6;
  const phantoms::Box box = field_box(plan);
  const hw::ProbeGeometry geometry = plan.geometry();
  const glm::dvec3 size = box.high - box.low;
  const auto& materials = subject.phantom.materials();
  const auto count = static_cast<std::uint64_t>(options.clutter.particles_per_cm3 /
                                                kCubicCentimetre * size.x * size.y * size.z);
  const double rms = amplitude_of_db(options.clutter.particle_echo_db);
  phantoms::PointScatterers particles;
  for (std::uint64_t i = 0; i < count; ++i) {
    const std::uint64_t key = random_key(options.seed, RandomStream::particles, i);
    const auto uniform = [&](std::uint64_t n) { return unit_interval(uniform_bits(key, n)); };
    const glm::dvec3 probe_m = box.low + size * glm::dvec3(uniform(0), uniform(1), uniform(2));
    if (!in_field(plan, geometry, probe_m)) continue;
    const glm::dvec3 rest_m = subject.to_rest(probe_m, 0);
    const auto& material = materials[static_cast<std::size_t>(map.material(rest_m))];
    if (material.backscatter_db > kZeroAmplitude_db) continue;
    const float normal = bell(static_cast<std::uint32_t>(uniform_bits(key, 3)));
    particles.add({rest_m, rms * static_cast<double>(normal)});
  }
  return particles;
}

}  // namespace wobblebench::sim
