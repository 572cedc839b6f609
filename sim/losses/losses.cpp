#include "sim/losses/losses.h"

#include <algorithm>
#include <cmath>

namespace wobblebench::sim {

namespace {

constexpr double kCentimetre = 1e-2;
/// Echoes so far below the noise or the dynamic range are invisible.
constexpr double kInvisible_db = 20;

/// Two-way loss for a centimetre of range at the centre frequency.
double two_way_db_per_cm(const hw::AcquisitionPlan& plan, double alpha_db_per_cm_mhz) {
  return 2 * alpha_db_per_cm_mhz * plan.probe().center_frequency_hz / kMegahertz;
}

}  // namespace

double roughness(const phantoms::Material& before, const phantoms::Material& behind) {
  return std::max(before.roughness, behind.roughness);
}

double reflection(const phantoms::Material& before,
                  const phantoms::Material& behind,
                  double cos_incidence) {
  const double cos_in = std::clamp(cos_incidence, 0.0, 1.0);
  const double ratio = behind.sound_speed_m_s / before.sound_speed_m_s;
  const double sin2_through = ratio * ratio * (1 - cos_in * cos_in);
  if (sin2_through >= 1) return 1;
  const double in = behind.impedance_rayl * cos_in;
  const double through = before.impedance_rayl * std::sqrt(1 - sin2_through);
  return (in - through) / (in + through);
}

double diffuse_echo(const phantoms::Material& before,
                    const phantoms::Material& behind,
                    double cos_incidence) {
  return roughness(before, behind) * std::abs(reflection(before, behind, cos_incidence)) *
         std::clamp(cos_incidence, 0.0, 1.0);
}

double specular_echo(const phantoms::Material& before,
                     const phantoms::Material& behind,
                     double cos_incidence,
                     const SimulationOptions& options) {
  // -3 dB of amplitude at half the width: exp(-ln(sqrt 2) (2 angle / width)^2).
  const double angle = std::acos(std::clamp(cos_incidence, 0.0, 1.0));
  const double relative = 2 * angle / options.specular_width_rad;
  const double lobe = std::exp(-0.5 * std::log(2.0) * relative * relative);
  return (1 - roughness(before, behind)) * lobe *
         std::abs(reflection(before, behind, cos_incidence));
}

double two_way_nepers_per_m(const hw::AcquisitionPlan& plan, double alpha_db_per_cm_mhz) {
  return two_way_db_per_cm(plan, alpha_db_per_cm_mhz) / kCentimetre * std::log(10.0) / 20;
}

double time_gain(const hw::AcquisitionPlan& plan,
                 const SimulationOptions& options,
                 double range_m) {
  return amplitude_of_db(two_way_db_per_cm(plan, options.tgc_db_per_cm_mhz) * range_m /
                         kCentimetre);
}

double visible_amplitude(const hw::AcquisitionPlan& plan, const SimulationOptions& options) {
  if (options.noise_db > kZeroAmplitude_db)
    return amplitude_of_db(options.noise_db - kInvisible_db);
  if (options.output == hw::SampleScale::linear_envelope) return 0;
  const double invisible_db = options.full_scale_db - options.dynamic_range_db - kInvisible_db;
  return amplitude_of_db(invisible_db) / time_gain(plan, options, plan.acquisition().depth_m);
}

}  // namespace wobblebench::sim
