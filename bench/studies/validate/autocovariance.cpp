#include "bench/studies/validate/autocovariance.h"

#include <cmath>
#include <stdexcept>

#include "base/units.h"
#include "bench/studies/validate/statistics.h"

namespace wobblebench::bench {

namespace {

/// Near the array's end the level falls by some dB a degree.
constexpr double kMiddle_rad = 0.3 * kDegree;

/// From the grid's middle to the middle of two lines.
double away_rad(const SpeckleGrid& grid, int line, int other) {
  const auto theta = [&](int i) { return grid.theta_rad[static_cast<std::size_t>(i)]; };
  return 0.5 * std::abs(theta(line) + theta(other) - theta(0) - theta(grid.lines() - 1));
}

double intensity(const SpeckleGrid& grid, int frame, int line, int sample) {
  const double amplitude = grid.at(frame, line, sample);
  return amplitude * amplitude;
}

}  // namespace

double intensity_correlation(const SpeckleGrid& grid,
                             const ScanWindow& window,
                             const ScanStep& step) {
  const int first = grid.sample_at(window.from_m), last = grid.sample_at(window.to_m);
  double covariance = 0, norm = 0;
  for (int line = 0; line + step.lines < grid.lines(); ++line) {
    if (away_rad(grid, line, line + step.lines) >= window.about_middle_rad) continue;
    Moments here, there;
    double products = 0;
    for (int f = 0; f + step.frames < grid.frames; ++f) {
      for (int k = first; k + step.samples < last; ++k) {
        const double x = intensity(grid, f, line, k);
        const double y = intensity(grid, f + step.frames, line + step.lines, k + step.samples);
        here.add(x);
        there.add(y);
        products += x * y;
      }
    }
    covariance += products / here.count - here.mean() * there.mean();
    norm += here.sigma() * there.sigma();
  }
  return covariance / norm;
}

double mean_intensity(const SpeckleGrid& grid, const ScanWindow& window) {
  const int first = grid.sample_at(window.from_m), last = grid.sample_at(window.to_m);
  Moments all;
  for (int line = 0; line < grid.lines(); ++line) {
    if (away_rad(grid, line, line) > kMiddle_rad) continue;
    for (int f = 0; f < grid.frames; ++f) {
      for (int k = first; k < last; ++k) all.add(intensity(grid, f, line, k));
    }
  }
  return all.mean();
}

double autocovariance_fwhm_m(const std::vector<double>& values, double lag_m) {
  double before = 0;  // minus the logarithm of the value at lag i
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double here = -std::log(std::max(values[i], 1e-3));
    if (here >= std::log(2.0)) {
      const double share = (std::log(2.0) - before) / (here - before);
      const double low = static_cast<double>(i), high = low + 1;
      return 2 * lag_m * std::sqrt(low * low + share * (high * high - low * low));
    }
    before = here;
  }
  throw std::runtime_error("speckle size: the autocovariance does not fall to half");
}

}  // namespace wobblebench::bench
