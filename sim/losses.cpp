#include "sim/losses.h"

#include <algorithm>
#include <cmath>

namespace wobblebench::sim {

namespace {

constexpr double kCentimetre = 1e-2;

/// dB lost there and back over a centimetre of range.
double two_way_db_per_cm(double alpha_db_per_cm_mhz, const hw::AcquisitionPlan& plan) {
  return 2 * alpha_db_per_cm_mhz * plan.probe().center_frequency_hz / kMegahertz;
}

}  // namespace

double reflection(const phantoms::Material& before, const phantoms::Material& behind) {
  return (behind.impedance_rayl - before.impedance_rayl) /
         (behind.impedance_rayl + before.impedance_rayl);
}

std::vector<float> two_way_amplitude(const TissueProfile& profile,
                                     const std::vector<phantoms::Material>& materials,
                                     const hw::AcquisitionPlan& plan,
                                     const SimulationOptions& options,
                                     double spacing_m,
                                     int count) {
  std::vector<float> amplitude(static_cast<std::size_t>(count), 1.0f);
  double level = 1;
  for (std::size_t s = 0; s < profile.stretches.size(); ++s) {
    const Stretch& stretch = profile.stretches[s];
    if (s > 0 && options.transmission_loss) {
      const double r = reflection(materials.at(profile.interfaces[s - 1].before),
                                  materials.at(profile.interfaces[s - 1].behind));
      level *= 1 - r * r;
    }
    double per_sample = 1;
    if (options.attenuation) {
      const double db_per_cm =
          two_way_db_per_cm(materials.at(stretch.material).attenuation_db_per_cm_mhz, plan);
      per_sample = amplitude_of_db(-db_per_cm * spacing_m / kCentimetre);
    }
    for (int i = stretch.first; i < stretch.last; ++i) {
      amplitude[static_cast<std::size_t>(i)] = static_cast<float>(level);
      level *= per_sample;
    }
  }
  return amplitude;
}

InterfaceEcho interface_echo(const Interface& interface,
                             const std::vector<phantoms::Material>& materials,
                             const SimulationOptions& options) {
  const phantoms::Material& before = materials.at(interface.before);
  const phantoms::Material& behind = materials.at(interface.behind);
  const double r = std::abs(reflection(before, behind));
  const double roughness = std::max(before.roughness, behind.roughness);
  const double cosine = std::min(1.0, interface.cos_incidence);
  // -3 dB of amplitude at half the width: exp(-ln(sqrt 2) (2 angle / width)^2).
  const double relative = 2 * std::acos(cosine) / options.specular_width_rad;
  const double lobe = std::exp(-0.5 * std::log(2.0) * relative * relative);
  return {r * (1 - roughness) * lobe, r * roughness * cosine};
}

double time_gain(const hw::AcquisitionPlan& plan,
                 const SimulationOptions& options,
                 double range_m) {
  return amplitude_of_db(two_way_db_per_cm(options.tgc_db_per_cm_mhz, plan) * range_m /
                         kCentimetre);
}

}  // namespace wobblebench::sim
