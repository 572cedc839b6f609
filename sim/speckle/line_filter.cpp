#include "sim/speckle/line_filter.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "base/units.h"
#include "sim/math/complex.h"
#include "sim/math/simd.h"
#include "sim/optics/beam_profile.h"

namespace wobblebench::sim {

namespace {

using Complex = std::complex<float>;

constexpr double kRangeStep_m = 5e-3;
/// -25 dB. Factors of neighbouring ranges are alike with it, and so can be interpolated.
constexpr double kNoiseShare = 3e-3;

/// A value that changes evenly along the stick.
struct Ramp {
  float first;
  float step;
};

WOBBLEBENCH_SIMD void scale(float* target, Ramp weight, int count) {
  for (int i = 0; i < count; ++i) {
    const std::ptrdiff_t at = 2 * static_cast<std::ptrdiff_t>(i);
    const float here = weight.first + weight.step * static_cast<float>(i);
    target[at] *= here;
    target[at + 1] *= here;
  }
}

WOBBLEBENCH_SIMD void add_weighted(float* __restrict target,
                                   const float* source,
                                   Ramp weight,
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
WOBBLEBENCH_SIMD void normalise(float* target, Ramp share, Ramp correlation, int count) {
  for (int i = 0; i < count; ++i) {
    const std::ptrdiff_t at = 2 * static_cast<std::ptrdiff_t>(i);
    const float x = static_cast<float>(i), second = share.first + share.step * x;
    const float apart = 1.0f - (correlation.first + correlation.step * x);
    const float power = 1.0f - 2.0f * second * (1.0f - second) * apart;
    const float amplitude = 1.0f / std::sqrt(power);
    target[at] *= amplitude;
    target[at + 1] *= amplitude;
  }
}

/// Entry of a factor; 0 beyond its band.
double weight_at(const BandedMatrix& factor, int row, int lag) {
  return lag <= factor.band ? factor.at(row, lag) : 0;
}

/// Correlation of what a row of a factor makes of noise and what the row `lag` before it of another
/// does.
double correlation(const BandedMatrix& one, int row, const BandedMatrix& other, int lag) {
  double sum = 0;
  for (int k = lag; k <= std::min(row, one.band); ++k) {
    sum += one.at(row, k) * weight_at(other, row - lag, k - lag);
  }
  return sum;
}

std::vector<BandedMatrix> factors_by_range(const LineCovariance& covariance,
                                           const BeamGrid& grid,
                                           int threads) {
  std::vector<BandedMatrix> factors(static_cast<std::size_t>(grid.ranges()));
  parallel_ranges(grid.ranges(), threads, [&](int first, int last) {
    for (int i = first; i < last; ++i) {
      factors[static_cast<std::size_t>(i)] =
          cholesky_factor(covariance.at(grid.range_m(i)), kNoiseShare);
    }
  });
  return factors;
}

}  // namespace

LineFilter::LineFilter(const hw::AcquisitionPlan& plan,
                       const SimulationOptions& options,
                       int samples,
                       double spacing_m)
    : samples_(samples),
      lines_(plan.acquisition().sticks_per_frame),
      factored_(EvenLines::needed(plan)) {
  const BeamGrid grid(plan, kRangeStep_m, kPi);  // of its ranges
  factors_ =
      factors_by_range(LineCovariance(plan, options.apodisation, factored_), grid, options.threads);
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
  // Of a dense scan the noise of the first lines serves as that of the lines that are factored.
  std::vector<Complex> copy;
  if (factored_.count < lines_) {
    copy.assign(frame, frame + static_cast<std::ptrdiff_t>(factored_.count) * samples_);
  }
  Complex* noise = copy.empty() ? frame : copy.data();
  // A line is a sum over the noise of lines up to it, so that they are overwritten from the last to
  // the first.
  for (int line = factored_.count - 1; line >= 0; --line) {
    for (const Span& span : spans_) correlate(noise, line, span);
  }
  if (copy.empty()) return;
  for (int line = 0; line < lines_; ++line) {
    interpolate(noise, line, frame + static_cast<std::ptrdiff_t>(line) * samples_);
  }
}

void LineFilter::correlate(Complex* noise, int line, const Span& span) const {
  const BandedMatrix &near = factors_[span.near], &far = factors_[span.far];
  const auto parts = [&](int of_line) {
    return parts_of(noise + static_cast<std::ptrdiff_t>(of_line) * samples_ + span.first);
  };
  const auto weight = [&](int lag) {
    const auto first = static_cast<float>(weight_at(near, line, lag));
    const float change = static_cast<float>(weight_at(far, line, lag)) - first;
    return Ramp{first + change * span.share, change * span.share_step};
  };
  const int count = span.last - span.first;
  float* target = parts(line);
  scale(target, weight(0), count);
  for (int lag = 1; lag <= std::min(line, std::max(near.band, far.band)); ++lag) {
    add_weighted(target, parts(line - lag), weight(lag), count);
  }
  normalise(target,
            {span.share, span.share_step},
            {static_cast<float>(correlation(near, line, far, 0)), 0},
            count);
}

void LineFilter::interpolate(const Complex* from, int line, Complex* target) const {
  const double at = line * (factored_.count - 1.0) / (lines_ - 1);
  const int before = std::min(static_cast<int>(at), factored_.count - 2);
  const auto share = static_cast<float>(at - before);
  const Complex* first = from + static_cast<std::ptrdiff_t>(before) * samples_;
  const Complex* second = first + samples_;
  for (int i = 0; i < samples_; ++i) target[i] = (1 - share) * first[i] + share * second[i];
  for (const Span& span : spans_) {
    const auto neighbours = [&](std::size_t range) {
      return static_cast<float>(correlation(factors_[range], before + 1, factors_[range], 1));
    };
    const float near = neighbours(span.near), change = neighbours(span.far) - near;
    normalise(parts_of(target + span.first),
              {share, 0},
              {near + change * span.share, change * span.share_step},
              span.last - span.first);
  }
}

}  // namespace wobblebench::sim
