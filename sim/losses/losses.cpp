#include "sim/losses/losses.h"

#include <algorithm>
#include <cmath>

namespace wobblebench::sim {

namespace {

constexpr int kPieces = 20;  ///< of BandLoss

/// A beam meets an interface at a range of angles: its aperture's paths differ by some 7 degrees,
/// and over its width a surface of 20 to 50 mm radius turns by as much as 10 at grazing incidence.
/// Half of the range at grazing incidence; elsewhere it is in proportion to the squared sine.
constexpr double kSpread_rad = 20 * kDegree;
constexpr double kLeastSpread_rad = 1 * kDegree;
constexpr int kAngles = 9;

/// Two-way amplitude behind an interface: 1 - R^2, as the root of its mean square over the beam.
/// Angles at which sound passes the body by do not count.
double mean_transmission(const phantoms::Material& before,
                         const phantoms::Material& behind,
                         double cos_incidence) {
  const double cosine = std::clamp(cos_incidence, 0.0, 1.0);
  const double half_rad = kSpread_rad * (1 - cosine * cosine);
  // Only a faster material reflects totally.
  if (behind.sound_speed_m_s <= before.sound_speed_m_s || half_rad < kLeastSpread_rad) {
    const double r = reflection(before, behind, cosine);
    return 1 - r * r;
  }
  const double angle_rad = std::acos(cosine), low_rad = angle_rad - half_rad;
  const double high_rad = std::min(angle_rad + half_rad, 0.5 * kPi);
  double sum = 0;
  for (int i = 0; i < kAngles; ++i) {
    const double at_rad = low_rad + (i + 0.5) / kAngles * (high_rad - low_rad);
    const double r = reflection(before, behind, std::cos(at_rad));
    sum += (1 - r * r) * (1 - r * r);
  }
  return std::sqrt(sum / kAngles);
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
  constexpr double kCentimetre = 1e-2;
  return 2 * alpha_db_per_cm_mhz * plan.probe().center_frequency_hz / kMegahertz / kCentimetre *
         std::log(10.0) / 20;
}

BandLoss::BandLoss(const hw::ProbeOptions& probe) {
  const double sigma = probe.fractional_bandwidth / (2 * std::sqrt(2 * std::log(2.0)));
  variance_ = sigma * sigma;
  step_nepers_ = (1 - kLowest) / kPieces / variance_;
  // Logarithm of the normal distribution function, up to a constant.
  const auto log_phi = [](double x) { return std::log(std::erfc(-x / std::sqrt(2.0))); };
  const double all = (1 - kBandEnd) / sigma;
  const auto gain = [&](double nepers) {
    return 0.5 * nepers * nepers * variance_ + log_phi(all - nepers * sigma) - log_phi(all);
  };
  for (int i = 0; i < kPieces; ++i) {
    const double from = i * step_nepers_, to = from + step_nepers_;
    const double first = gain(from), middle = gain(from + 0.5 * step_nepers_), last = gain(to);
    pieces_.push_back({from,
                       to,
                       first,
                       (4 * middle - 3 * first - last) / step_nepers_,
                       2 * (first - 2 * middle + last) / (step_nepers_ * step_nepers_)});
  }
  const Piece& before = pieces_.back();
  const double slope = before.slope + 2 * before.curvature * step_nepers_;
  pieces_.push_back({before.to, HUGE_VAL, before.at(before.to), slope, 0});
}

const BandLoss::Piece& BandLoss::piece(double nepers) const {
  const double at = std::clamp(nepers / step_nepers_, 0.0, static_cast<double>(kPieces));
  return pieces_[static_cast<std::size_t>(at)];
}

double BandLoss::frequency_ratio(double nepers) const {
  return std::max(kLowest, 1 - nepers * variance_);
}

TissueLosses::TissueLosses(const hw::AcquisitionPlan& plan,
                           const SimulationOptions& options,
                           const std::vector<phantoms::Material>& materials)
    : materials_(&materials), interfaces_(options.transmission_loss) {
  for (const auto& material : materials) {
    const double alpha = options.attenuation ? material.attenuation_db_per_cm_mhz : 0;
    nepers_per_m_.push_back(two_way_nepers_per_m(plan, alpha));
  }
}

double TissueLosses::transmission(const Interface& crossed) const {
  if (!interfaces_) return 1;
  return mean_transmission(materials_->at(static_cast<std::size_t>(crossed.before)),
                           materials_->at(static_cast<std::size_t>(crossed.behind)),
                           crossed.cos_incidence);
}

}  // namespace wobblebench::sim
