#include "bench/output/chart/chart_axis.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "base/number_text.h"

namespace wobblebench::bench {

namespace {

/// Margin beyond the data at each end, as a fraction of the axis.
constexpr double kMargin = 0.04;

/// Digits after the decimal point that distinguish multiples of a step.
int digits_of(double step) {
  return std::clamp(static_cast<int>(std::ceil(-std::log10(step) - 1e-9)), 0, 9);
}

double nice_step(double least) {
  const double decade = std::pow(10.0, std::floor(std::log10(least)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * decade >= least * (1 - 1e-9)) return factor * decade;
  }
  return 10 * decade;
}

}  // namespace

Ruler::Ruler(const Axis& axis, const std::vector<double>& values)
    : scale_(axis.scale), ticks_(axis.ticks) {
  const bool log = scale_ == Scale::logarithmic;
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const double value : values) {
    if (!std::isfinite(value) || (log && value <= 0)) continue;
    low = std::min(low, value);
    high = std::max(high, value);
  }
  low_ = axis.low.value_or(low);
  high_ = axis.high.value_or(high);
  if (!std::isfinite(low_) || !std::isfinite(high_) || (log && low_ <= 0) || low_ > high_) {
    throw std::invalid_argument("axis " + axis.label + ": no values to show");
  }
  if (log) {
    const double margin = low_ == high_ ? 2 : std::pow(high_ / low_, kMargin);
    if (!axis.low) low_ /= margin;
    if (!axis.high) high_ *= margin;
    return;
  }
  double margin = kMargin * (high_ - low_);
  if (margin == 0) margin = high_ == 0 ? 1 : 0.1 * std::abs(high_);
  if (!axis.low) low_ -= margin;
  if (!axis.high) high_ += margin;
}

double Ruler::fraction(double value) const {
  if (scale_ == Scale::linear) return (value - low_) / (high_ - low_);
  return std::log(value / low_) / std::log(high_ / low_);
}

std::vector<Tick> Ruler::ticks(int most) const {
  if (!ticks_.empty()) return ticks_;
  return scale_ == Scale::linear ? linear_ticks(most) : logarithmic_ticks(most);
}

std::vector<Tick> Ruler::linear_ticks(int most) const {
  const double step = nice_step((high_ - low_) / most);
  std::vector<Tick> ticks;
  for (double n = std::ceil(low_ / step - 1e-6); n * step <= high_ + 1e-6 * step; ++n) {
    const double value = n == 0 ? 0 : n * step;  // no minus before a zero
    ticks.push_back({value, fixed(value, digits_of(step))});
  }
  return ticks;
}

std::vector<Tick> Ruler::logarithmic_ticks(int most) const {
  const double decades = std::log10(high_ / low_);
  if (decades < 0.7) return linear_ticks(most);
  const int every = std::max(1, static_cast<int>(std::ceil(decades / most)));
  const bool between = 3 * decades <= most + 1;
  std::vector<Tick> ticks;
  for (int p = static_cast<int>(std::floor(std::log10(low_))); std::pow(10.0, p) <= high_; ++p) {
    if (p % every != 0) continue;
    for (const double factor : {1.0, 2.0, 5.0}) {
      if (factor > 1 && !between) break;
      const double value = factor * std::pow(10.0, p);
      if (contains(value * (1 + 1e-9)) || contains(value * (1 - 1e-9))) {
        ticks.push_back({value, fixed(value, std::max(0, -p))});
      }
    }
  }
  return ticks;
}

}  // namespace wobblebench::bench
