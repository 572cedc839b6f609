#include "bench/studies/validate/reflection.h"

#include <algorithm>
#include <cmath>

#include "bench/studies/validate/bodies.h"
#include "bench/studies/validate/scan.h"
#include "bench/studies/validate/statistics.h"
#include "sim/optics/pulse_band.h"

namespace wobblebench::bench {

namespace {

constexpr double kCoarseVoxel_m = 2e-3;  // planes are exact at any voxel size
constexpr double kSpacing_m = 0.1e-3;
constexpr double kMargin_m = 5e-3;  // of the echo of a tilted plane, in range
constexpr double kWidestLobe_rad = 90 * kDegree;

/// The phantom plane of a material without backscatter: only its face echoes.
phantoms::Phantom bare_plane(double tilt_x_rad,
                             double tilt_y_rad,
                             double roughness,
                             const std::string& material_name) {
  const auto plane = phantoms::make_phantom({.name = "plane",
                                             .voxel_m = kCoarseVoxel_m,
                                             .tilt_x_rad = tilt_x_rad,
                                             .tilt_y_rad = tilt_y_rad});
  const phantoms::Material replacement = phantoms::material(material_name);
  return with_materials(plane, [&](phantoms::Material& material) {
    if (material.name == "soft_tissue") material = replacement;
    material.backscatter_db = sim::kZeroAmplitude_db;
    material.roughness = roughness;
  });
}

sim::SimulationOptions interface_alone(sim::Rung rung, std::uint64_t seed) {
  auto options = bare_envelope(rung, seed);
  options.attenuation = false;
  options.transmission_loss = false;
  return options;
}

double lobe(double angle_rad, double width_rad) {
  const double relative = 2 * angle_rad / width_rad;  // -3 dB where it is 1
  return std::pow(2.0, -0.5 * relative * relative);
}

double largest_echo(const phantoms::Phantom& plane, double lobe_width_rad) {
  const double depth_m = 0.09;
  const hw::AcquisitionPlan plan({},
                                 {.depth_m = depth_m,
                                  .sticks_per_frame = 1,
                                  .samples_per_stick = static_cast<int>(depth_m / kSpacing_m),
                                  .frames_per_volume = 1});
  auto options = interface_alone(sim::Rung::field, 1);
  options.specular_width_rad = lobe_width_rad;
  const auto volume = scan(phantoms::still_at(plane, plane.suggested_position_m()), plan, options);
  return gaussian_peak(volume.stick(0, 0)).value;
}

/// Tilted about x for even `index`, about y for odd.
phantoms::Phantom tilted(double angle_rad, int index, const std::string& material_name) {
  const bool about_x = index % 2 == 0;
  return bare_plane(about_x ? angle_rad : 0, about_x ? 0 : -angle_rad, 0, material_name);
}

/// Angles come from the fan: in a narrow sector no aperture reaches the array's end, where echoes
/// are weaker.
constexpr double kDiffuseSector_rad = 30 * kDegree, kDiffuseFan_rad = 90 * kDegree;

}  // namespace

double fresnel(const phantoms::Material& before,
               const phantoms::Material& behind,
               double angle_rad) {
  const double sin_through = behind.sound_speed_m_s / before.sound_speed_m_s * std::sin(angle_rad);
  if (sin_through >= 1) return 1;
  const double in = behind.impedance_rayl * std::cos(angle_rad);
  const double through = before.impedance_rayl * std::cos(std::asin(sin_through));
  return (in - through) / (in + through);
}

std::vector<AnglePoint> measure_lobe(const ReflectionInputs& inputs) {
  const auto& fluid = phantoms::material("amniotic_fluid");
  const auto& tissue = phantoms::material("soft_tissue");
  const double width_rad = sim::SimulationOptions{}.specular_width_rad;
  std::vector<AnglePoint> points;
  for (const double degrees : inputs.lobe_deg) {
    const double angle = degrees * kDegree;
    const auto plane = tilted(angle, static_cast<int>(points.size()), "soft_tissue");
    points.push_back({angle,
                      largest_echo(plane, width_rad),
                      std::abs(fresnel(fluid, tissue, angle)) * lobe(angle, width_rad),
                      1});
  }
  return points;
}

std::vector<AnglePoint> measure_fresnel(const ReflectionInputs& inputs) {
  const auto& fluid = phantoms::material("amniotic_fluid");
  const auto& bone = phantoms::material("cortical_bone");
  std::vector<AnglePoint> points;
  for (const double degrees : inputs.fresnel_deg) {
    const double angle = degrees * kDegree;
    const auto plane = tilted(angle, static_cast<int>(points.size()), "cortical_bone");
    points.push_back({angle,
                      largest_echo(plane, kWidestLobe_rad) / lobe(angle, kWidestLobe_rad),
                      std::abs(fresnel(fluid, bone, angle)),
                      1});
  }
  return points;
}

std::vector<AnglePoint> measure_diffuse(sim::Rung rung, const ReflectionInputs& inputs) {
  const auto& fluid = phantoms::material("amniotic_fluid");
  const auto& tissue = phantoms::material("soft_tissue");
  const double depth_m = 0.105;  // ends before the back of the slab
  const hw::AcquisitionPlan plan({},
                                 {.depth_m = depth_m,
                                  .sector_rad = kDiffuseSector_rad,
                                  .fan_rad = kDiffuseFan_rad,
                                  .sticks_per_frame = inputs.sticks,
                                  .samples_per_stick = static_cast<int>(depth_m / kSpacing_m),
                                  .frames_per_volume = inputs.frames});
  const auto plane = bare_plane(0, 0, 1, "soft_tissue");
  const double bin_rad = inputs.diffuse_bin_deg * kDegree;
  std::vector<Moments> energy, expected, angles;
  // Equivalent length of the pulse: its energy over its peak power.
  const double length_m = std::sqrt(kPi) * sim::sigma_of_fwhm(sim::axial_fwhm_m(plan));
  for (const std::uint64_t seed : inputs.seeds) {
    const Scan volume = scan(
        phantoms::still_at(plane, plane.suggested_position_m()), plan, interface_alone(rung, seed));
    for (int f = 0; f < inputs.frames; ++f) {
      for (int l = 0; l < inputs.sticks; ++l) {
        const auto ray = plan.geometry().stick(plan.theta_rad(l), plan.frame_phi_rad(f));
        const double cosine = ray.direction.z;
        const double face_m = (plane.suggested_position_m().z - ray.origin.z) / cosine;
        if (face_m > depth_m - kMargin_m) continue;
        const double angle = std::acos(cosine);
        const auto bin = static_cast<std::size_t>(angle / bin_rad);
        if (bin >= energy.size()) {
          energy.resize(bin + 1);
          expected.resize(bin + 1);
          angles.resize(bin + 1);
        }
        double sum = 0;
        for (const double value : volume.stick(f, l)) {
          sum += value * value * plan.sample_spacing_m();
        }
        energy[bin].add(sum / length_m);
        const double mean = std::abs(fresnel(fluid, tissue, angle)) * cosine;
        expected[bin].add(4 / kPi * mean * mean);
        angles[bin].add(angle);
      }
    }
  }
  std::vector<AnglePoint> points;
  for (std::size_t bin = 0; bin < energy.size(); ++bin) {
    if (energy[bin].count < 100) continue;
    // The mean of a Rayleigh envelope from its mean intensity.
    points.push_back({angles[bin].mean(),
                      std::sqrt(kPi / 4 * energy[bin].mean()),
                      std::sqrt(kPi / 4 * expected[bin].mean()),
                      static_cast<long>(energy[bin].count)});
  }
  return points;
}

}  // namespace wobblebench::bench
