#include "sim/echo/line_filter.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/parallel.h"
#include "sim/beam/point_spread.h"
#include "sim/beam/profile/beam_profile.h"
#include "sim/math/simd.h"

namespace wobblebench::sim {

namespace {

using Complex = std::complex<float>;

constexpr double kRangeStep_m = 5e-3;
/// -25 dB. Factors of neighbouring ranges are alike with it, and so can be interpolated.
constexpr double kGrain = 3e-3;

float* parts_of(Complex* values) {
  return reinterpret_cast<float*>(values);
}

/// A weight that changes evenly along the stick.
struct Weight {
  float first;
  float step;
};

WOBBLEBENCH_SIMD void scale(float* target, Weight weight, int count) {
  for (int i = 0; i < count; ++i) {
    const std::ptrdiff_t at = 2 * static_cast<std::ptrdiff_t>(i);
    const float here = weight.first + weight.step * static_cast<float>(i);
    target[at] *= here;
    target[at + 1] *= here;
  }
}

WOBBLEBENCH_SIMD void add_weighted(float* __restrict target,
                                   const float* source,
                                   Weight weight,
                                   int count) {
  for (int i = 0; i < count; ++i) {
    const std::ptrdiff_t at = 2 * static_cast<std::ptrdiff_t>(i);
    const float here = weight.first + weight.step * static_cast<float>(i);
    target[at] += here * source[at];
    target[at + 1] += here * source[at + 1];
  }
}

/// To unit power, of the mean by `share` of two fields of unit power that correlate by
/// `correlation`.
WOBBLEBENCH_SIMD void normalise(float* target, Weight share, float correlation, int count) {
  for (int i = 0; i < count; ++i) {
    const std::ptrdiff_t at = 2 * static_cast<std::ptrdiff_t>(i);
    const float second = share.first + share.step * static_cast<float>(i);
    const float power = 1.0f - 2.0f * second * (1.0f - second) * (1.0f - correlation);
    const float amplitude = 1.0f / std::sqrt(power);
    target[at] *= amplitude;
    target[at + 1] *= amplitude;
  }
}

/// Entry of a factor; 0 beyond its band.
double weight_at(const BandedMatrix& factor, int row, int lag) {
  return lag <= factor.band ? factor.at(row, lag) : 0;
}

/// Correlation of what the same row of two factors makes of one noise.
double correlation(const BandedMatrix& one, const BandedMatrix& other, int row) {
  double sum = 0;
  for (int lag = 0; lag <= one.band; ++lag) sum += one.at(row, lag) * weight_at(other, row, lag);
  return sum;
}

std::vector<BandedMatrix> factors_by_range(const LineCovariance& covariance,
                                           const BeamGrid& grid,
                                           int threads) {
  std::vector<std::optional<BandedMatrix>> factors(static_cast<std::size_t>(grid.ranges()));
  parallel_ranges(grid.ranges(), threads, [&](int first, int last) {
    for (int i = first; i < last; ++i) {
      factors[static_cast<std::size_t>(i)] =
          cholesky_factor(covariance.at(grid.range_m(i)), kGrain);
    }
  });
  std::vector<BandedMatrix> all;
  for (auto& factor : factors) all.push_back(std::move(*factor));
  return all;
}

}  // namespace

LineFilter::LineFilter(const hw::AcquisitionPlan& plan,
                       const SimulationOptions& options,
                       int samples,
                       double spacing_m)
    : samples_(samples), lines_(plan.acquisition().sticks_per_frame) {
  const BeamGrid grid(plan, kRangeStep_m, kPi);
  factors_ = factors_by_range(LineCovariance(plan, options.apodisation), grid, options.threads);
  for (int i = 0; i < samples; ++i) {
    const BeamGrid::Between at = grid.range_at((i + 0.5) * spacing_m);
    const std::size_t far = at.share > 0 ? at.second : at.first;
    if (spans_.empty() || spans_.back().near != at.first || spans_.back().far != far) {
      spans_.push_back({i, i, at.first, far, static_cast<float>(at.share), 0});
    }
    Span& span = spans_.back();
    span.last = i + 1;
    if (i > span.first) {
      span.share_step =
          (static_cast<float>(at.share) - span.share) / static_cast<float>(i - span.first);
    }
  }
}

void LineFilter::apply(Complex* frame) const {
  // A line is a sum over the noise of those before it: from the last one on all are overwritten.
  for (int line = lines_ - 1; line >= 0; --line) {
    for (const Span& span : spans_) correlate(frame, line, span);
  }
}

void LineFilter::correlate(Complex* frame, int line, const Span& span) const {
  const BandedMatrix &near = factors_[span.near], &far = factors_[span.far];
  const auto parts = [&](int of_line) {
    return parts_of(frame + static_cast<std::ptrdiff_t>(of_line) * samples_ + span.first);
  };
  const auto weight = [&](int lag) {
    const auto first = static_cast<float>(weight_at(near, line, lag));
    const float change = static_cast<float>(weight_at(far, line, lag)) - first;
    return Weight{first + change * span.share, change * span.share_step};
  };
  const int count = span.last - span.first;
  float* target = parts(line);
  scale(target, weight(0), count);
  for (int lag = 1; lag <= std::min(line, std::max(near.band, far.band)); ++lag) {
    add_weighted(target, parts(line - lag), weight(lag), count);
  }
  normalise(target,
            {span.share, span.share_step},
            static_cast<float>(correlation(near, far, line)),
            count);
}

}  // namespace wobblebench::sim
