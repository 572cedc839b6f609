#include "bench/evaluation/bound/detection_bound.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "base/number_text.h"
#include "base/units.h"
#include "bench/evaluation/bound/neighbour_modes.h"
#include "sim/optics/beam_profile.h"
#include "sim/optics/pulse_band.h"

namespace wobblebench::bench {

namespace {

/// Places of the surface between two samples.
constexpr int kPhases = 4;
/// A Gaussian rise of so many sigmas is 98 dB below its plateau.
constexpr double kBeforeSigmas = 6.2;
constexpr double kBehindSigmas = 4.5;

double power_of_db(double db) {
  return db <= sim::kZeroAmplitude_db ? 0 : std::pow(10.0, db / 10);
}

double pulse_sigma_m(const DetectionConditions& conditions) {
  return sim::sigma_of_fwhm(conditions.pulse_fwhm_m);
}

void require(bool allowed, const std::string& field, double value, const std::string& range) {
  if (allowed) return;
  throw std::invalid_argument("detection_bound_m: " + field + " = " + significant(value, 6) + ": " +
                              range);
}

/// The mean over the surface's place between samples of the inverse of an information, to the root.
template <class Information>
double root_mean_bound_m(const DetectionConditions& conditions,
                         double spacing_m,
                         const Information& information) {
  const SampleWindow window = sample_window(conditions);
  double sum = 0;
  for (int phase = 0; phase < kPhases; ++phase) {
    sum += 1 / information((phase + 0.5) / kPhases * spacing_m, window);
  }
  return std::sqrt(sum / kPhases);
}

}  // namespace

void validate(const DetectionConditions& c) {
  const auto positive = [](const std::string& field, double value) {
    require(value > 0 && std::isfinite(value), field, value, "must be positive");
  };
  require(c.incidence_rad >= 0 && c.incidence_rad <= kMostIncidence_rad + 1e-9,
          "incidence_rad",
          c.incidence_rad,
          "must be within 0 and 80 degrees");
  positive("lateral_fwhm_m", c.lateral_fwhm_m);
  positive("elevation_fwhm_m", c.elevation_fwhm_m);
  positive("pulse_fwhm_m", c.pulse_fwhm_m);
  positive("sample_spacing_m", c.sample_spacing_m);
  require(c.sample_spacing_m >= c.pulse_fwhm_m / 50,
          "sample_spacing_m",
          c.sample_spacing_m,
          "must be at least a fiftieth of pulse_fwhm_m");
  positive("line_spacing_m", c.line_spacing_m);
  positive("frame_spacing_m", c.frame_spacing_m);
  const double below_db = std::max(c.noise_db, c.fluid_db);
  require(c.noise_db >= c.tissue_db - 80 && std::isfinite(c.noise_db),
          "noise_db",
          c.noise_db,
          "must be at most 80 dB below tissue_db: without noise the bound is 0");
  require(c.tissue_db > below_db - 30 && c.tissue_db != c.fluid_db && std::isfinite(c.tissue_db),
          "tissue_db",
          c.tissue_db,
          "must be no more than 30 dB below noise and fluid, and another than the fluid's");
}

double rise_sigma_m(const DetectionConditions& c) {
  const double pulse_m = sim::power_sigma(c.pulse_fwhm_m);
  const double slope = std::tan(c.incidence_rad);
  const double lateral_m = sim::power_sigma(c.lateral_fwhm_m) * slope * std::cos(c.azimuth_rad);
  const double elevation_m = sim::power_sigma(c.elevation_fwhm_m) * slope * std::sin(c.azimuth_rad);
  return std::hypot(pulse_m, lateral_m, elevation_m);
}

EdgeSignal edge_signal(const DetectionConditions& c) {
  return {.tissue_power = power_of_db(c.tissue_db),
          .fluid_power = power_of_db(c.fluid_db),
          .noise_power = power_of_db(c.noise_db),
          .spacing_m = c.sample_spacing_m,
          .pair = pulse_after_edge(gaussian_correlation(pulse_sigma_m(c)),
                                   gaussian_rise(rise_sigma_m(c)))};
}

SampleWindow sample_window(const DetectionConditions& c) {
  const double pulse_m = 4 * pulse_sigma_m(c), rise_m = rise_sigma_m(c);
  const double before_m = kBeforeSigmas * rise_m + pulse_m;
  const double length_m = before_m + kBehindSigmas * rise_m + pulse_m;
  return {-before_m, static_cast<int>(std::ceil(length_m / c.sample_spacing_m)) + 1};
}

double detection_bound_m(const DetectionConditions& conditions) {
  validate(conditions);
  const std::vector<double> modes = neighbour_modes(conditions);
  const EdgeSignal stick = edge_signal(conditions);
  return root_mean_bound_m(
      conditions, conditions.sample_spacing_m, [&](double edge_m, const SampleWindow& window) {
        double information = 0;
        for (const double mode : modes) {
          EdgeSignal signal = stick;
          signal.tissue_power *= mode;
          signal.fluid_power *= mode;
          const auto covariance = edge_covariance(signal, edge_m, window.first_m, window.count);
          information += covariance_information(covariance.value, covariance.derivative);
        }
        return information;
      });
}

double envelope_bound_m(const DetectionConditions& conditions, double detected_spacing_m) {
  DetectionConditions detected = conditions;
  detected.sample_spacing_m = detected_spacing_m;
  validate(detected);
  const EdgeSignal signal = edge_signal(detected);
  return root_mean_bound_m(
      detected, detected_spacing_m, [&](double edge_m, const SampleWindow& window) {
        const EdgePower power = edge_power(signal, edge_m, window.first_m, window.count);
        return independent_information(power.value, power.derivative);
      });
}

}  // namespace wobblebench::bench
