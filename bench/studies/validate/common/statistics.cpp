#include "bench/studies/validate/common/statistics.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace wobblebench::bench {

std::vector<std::uint64_t> seeds_from(std::uint64_t first, int count) {
  std::vector<std::uint64_t> seeds;
  for (int i = 0; i < count; ++i) seeds.push_back(first + static_cast<std::uint64_t>(i));
  return seeds;
}

double Moments::sigma() const {
  return std::sqrt(std::max(0.0, mean_square() - mean() * mean()));
}

double rayleigh_distance(std::vector<double> envelope) {
  std::sort(envelope.begin(), envelope.end());
  const double n = static_cast<double>(envelope.size());
  double mean_square = 0;
  for (const double value : envelope) mean_square += value * value / n;
  double distance = 0;
  for (std::size_t i = 0; i < envelope.size(); ++i) {
    const double expected = -std::expm1(-envelope[i] * envelope[i] / mean_square);
    const double below = static_cast<double>(i) / n, above = static_cast<double>(i + 1) / n;
    distance = std::max({distance, expected - below, above - expected});
  }
  return distance;
}

double rayleigh_critical_distance(double n) {
  return 1.308 / (std::sqrt(n) + 0.26 + 0.5 / std::sqrt(n)) + 0.2 / n;
}

Line fit_line(std::span<const double> x, std::span<const double> y) {
  const double n = static_cast<double>(x.size());
  double mean_x = 0, mean_y = 0, xx = 0, xy = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    mean_x += x[i] / n;
    mean_y += y[i] / n;
  }
  for (std::size_t i = 0; i < x.size(); ++i) {
    xx += (x[i] - mean_x) * (x[i] - mean_x);
    xy += (x[i] - mean_x) * (y[i] - mean_y);
  }
  const double slope = xy / xx;
  return {slope, mean_y - slope * mean_x};
}

double full_width_at_half(std::span<const double> x, std::span<const double> y) {
  const auto top = std::max_element(y.begin(), y.end());
  const double half = 0.5 * *top;
  const auto crossing = [&](std::size_t inner, std::size_t outer) {
    return x[inner] + (x[outer] - x[inner]) * (y[inner] - half) / (y[inner] - y[outer]);
  };
  std::size_t low = static_cast<std::size_t>(top - y.begin()), high = low;
  while (low > 0 && y[low] >= half) --low;
  while (high + 1 < y.size() && y[high] >= half) ++high;
  if (y[low] >= half || y[high] >= half) {
    throw std::runtime_error("full_width_at_half: the profile does not fall to half on both sides");
  }
  return crossing(high - 1, high) - crossing(low + 1, low);
}

Peak gaussian_peak(std::span<const double> y) {
  const auto top = static_cast<std::size_t>(std::max_element(y.begin(), y.end()) - y.begin());
  const bool inside = top > 0 && top + 1 < y.size() && y[top - 1] > 0 && y[top + 1] > 0;
  if (!inside) return {static_cast<double>(top), y[top]};
  const double before = std::log(y[top - 1]), here = std::log(y[top]),
               behind = std::log(y[top + 1]);
  const double bend = before - 2 * here + behind;
  if (!(bend < 0)) return {static_cast<double>(top), y[top]};
  const double offset = 0.5 * (before - behind) / bend;
  return {static_cast<double>(top) + offset, std::exp(here - 0.25 * (before - behind) * offset)};
}

}  // namespace wobblebench::bench
