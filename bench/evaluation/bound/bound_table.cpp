#include "bench/evaluation/bound/picture_bound.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "sim/optics/beam_profile.h"

namespace wobblebench::bench {

namespace {

constexpr double kRiseStep = 0.05;  ///< of its logarithm
constexpr double kEchoStep_db = 1;
constexpr double kDensityStep = 0.1;

/// Below two sticks a width a stick has no neighbour in its beam.
int density_steps(double fwhm_m, double spacing_m) {
  const double density = fwhm_m / spacing_m;
  return density < 2 ? 0 : static_cast<int>(std::lround(density / kDensityStep));
}

double spacing_m(double fwhm_m, int steps) {
  return steps == 0 ? fwhm_m : fwhm_m / (steps * kDensityStep);
}

}  // namespace

BoundTable::Entry BoundTable::add(const DetectionConditions& c) {
  const double widening = rise_sigma_m(c) / sim::power_sigma(like_.pulse_fwhm_m);
  const Key key{static_cast<int>(std::lround(std::log(widening) / kRiseStep)),
                static_cast<int>(std::lround(c.tissue_db / kEchoStep_db)),
                density_steps(c.lateral_fwhm_m, c.line_spacing_m),
                density_steps(c.elevation_fwhm_m, c.frame_spacing_m)};
  const auto [at, is_new] = entries_.try_emplace(key, keys_.size());
  if (is_new) keys_.push_back(key);
  return at->second;
}

/// A slope in the image plane that gives the rise.
DetectionConditions BoundTable::conditions_of(const Key& key) const {
  DetectionConditions c = like_;
  const double widening = std::exp(key[0] * kRiseStep);
  const double pulse_m = sim::power_sigma(like_.pulse_fwhm_m);
  const double footprint_m = pulse_m * std::sqrt(std::max(0.0, widening * widening - 1));
  // As wide a beam as keeps the incidence at 45 degrees.
  c.incidence_rad = footprint_m > 0 ? 45 * kDegree : 0;
  c.azimuth_rad = 0;
  if (footprint_m > 0) c.lateral_fwhm_m *= footprint_m / sim::power_sigma(c.lateral_fwhm_m);
  c.tissue_db = key[1] * kEchoStep_db;
  c.line_spacing_m = spacing_m(c.lateral_fwhm_m, key[2]);
  c.frame_spacing_m = spacing_m(c.elevation_fwhm_m, key[3]);
  return c;
}

void BoundTable::compute() {
  for (const Key& key : keys_) validate(conditions_of(key));
  bounds_.resize(keys_.size());
  parallel_rows(static_cast<int>(keys_.size()), [&](int i) {
    const auto at = static_cast<std::size_t>(i);
    bounds_[at] = detection_bound_m(conditions_of(keys_[at]));
  });
}

}  // namespace wobblebench::bench
