#include "sim/speckle/iq_field.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "base/parallel.h"
#include "sim/math/fast_math.h"
#include "sim/math/random.h"
#include "sim/speckle/line_covariance.h"
#include "sim/speckle/speckle_kernels.h"

namespace wobblebench::sim {

namespace {

using Complex = std::complex<float>;

WOBBLEBENCH_SIMD void fill_noise(float* parts, int count, std::uint64_t key) {
  for (int i = 0; i < count; ++i) {
    const ComplexNormal z = complex_normal(key, static_cast<std::uint32_t>(i));
    const std::ptrdiff_t at = 2 * static_cast<std::ptrdiff_t>(i);
    parts[at] = z.re;
    parts[at + 1] = z.im;
  }
}

/// target[i] += weights[i] * source[i].
WOBBLEBENCH_SIMD void add_weighted(float* target,
                                   const float* source,
                                   const float* weights,
                                   int count) {
  for (int i = 0; i < count; ++i) {
    const std::ptrdiff_t at = 2 * static_cast<std::ptrdiff_t>(i);
    target[at] += weights[i] * source[at];
    target[at + 1] += weights[i] * source[at + 1];
  }
}

/// Symmetric kernels across frames, one per range, stored tap by tap so that loops run along the
/// stick.
class RangeKernels {
 public:
  RangeKernels(int samples, double spacing_m, const SpeckleKernels& kernels, int angle)
      : samples_(samples), half_(kernels.count() - 1) {
    // Kernels are widest near the face, where sticks are dense.
    ends_.assign(static_cast<std::size_t>(half_) + 1, 0);
    taps_.assign((static_cast<std::size_t>(half_) + 1) * static_cast<std::size_t>(samples), 0.0f);
    for (int i = 0; i < samples; ++i) {
      const std::vector<float> taps = kernels.taps((i + 0.5) * spacing_m, angle);
      for (std::size_t tap = 0; tap < taps.size(); ++tap) {
        taps_[at(static_cast<int>(tap)) + static_cast<std::size_t>(i)] = taps[tap];
        ends_[tap] = i + 1;
      }
    }
  }

  int half() const { return half_; }
  /// End of the samples at which the tap is nonzero.
  int end(int tap) const { return ends_[static_cast<std::size_t>(tap)]; }
  const float* tap(int tap) const { return taps_.data() + at(tap); }
  int samples() const { return samples_; }

 private:
  std::size_t at(int tap) const { return static_cast<std::size_t>(tap) * samples_; }

  int samples_;
  int half_ = 0;
  std::vector<int> ends_;    ///< of each tap
  std::vector<float> taps_;  ///< [tap][sample]
};

/// Filters across the `count` sticks of a line, `stride` complex values apart. At the edges the
/// taps outside the field are dropped and the others scaled up, so that the power is the same
/// there.
void filter_line(Complex* values, int count, std::size_t stride, const RangeKernels& kernels) {
  const auto samples = static_cast<std::size_t>(kernels.samples());
  std::vector<Complex> before(samples * static_cast<std::size_t>(count));
  for (int n = 0; n < count; ++n) {
    std::copy_n(
        values + n * stride, samples, before.begin() + static_cast<std::ptrdiff_t>(n * samples));
  }
  std::vector<float> power(samples);
  for (int n = 0; n < count; ++n) {
    Complex* target = values + n * stride;
    std::fill_n(target, samples, Complex(0));
    std::fill(power.begin(), power.end(), 0.0f);
    for (int offset = -kernels.half(); offset <= kernels.half(); ++offset) {
      const int source = n + offset;
      if (source < 0 || source >= count) continue;
      const int tap = std::abs(offset);
      const float* weights = kernels.tap(tap);
      add_weighted(parts_of(target),
                   parts_of(before.data() + static_cast<std::size_t>(source) * samples),
                   weights,
                   kernels.end(tap));
      for (int i = 0; i < kernels.end(tap); ++i) {
        power[static_cast<std::size_t>(i)] += weights[i] * weights[i];
      }
    }
    if (n >= kernels.half() && n + kernels.half() < count) continue;
    for (std::size_t i = 0; i < samples; ++i) target[i] /= std::sqrt(power[i]);
  }
}

constexpr double kFactorStep_m = 5e-3;
/// Share of white noise, -25 dB. With it the factors of neighbouring ranges are similar and can be
/// interpolated.
constexpr double kNoiseShare = 3e-3;

/// A linear function of the sample along the stick.
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

WOBBLEBENCH_SIMD void add_ramped(float* __restrict target,
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

/// Scales to unit power a field that is the mean, by `share`, of two fields of unit power whose
/// correlation is `correlation`.
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
double factor_weight(const BandedMatrix& factor, int row, int lag) {
  return lag <= factor.band ? factor.at(row, lag) : 0;
}

/// Correlation of two filtered lines: by a row of one factor, and by the row `lag` before it of
/// another.
double correlation(const BandedMatrix& one, int row, const BandedMatrix& other, int lag) {
  double sum = 0;
  for (int k = lag; k <= std::min(row, one.band); ++k) {
    sum += one.at(row, k) * factor_weight(other, row - lag, k - lag);
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

/// Gives the white noise of a frame the correlation that speckle has between its lines. Multiplies
/// by the triangular factor of the lines' covariance, which is valid for lines with different
/// apertures and at the ends of the scan. The mean power is unchanged.
class LineFilter {
 public:
  /// For sticks at the IQ rate.
  explicit LineFilter(const ProbeOptics& optics);

  /// `frame`: lines x samples, sample fastest.
  void apply(std::complex<float>* frame) const;

 private:
  /// Samples between two ranges at which the covariance is factored.
  struct Span {
    int first, last;        ///< first sample, and the one behind the last
    std::size_t near, far;  ///< indices in factors_
    float share;            ///< weight of the far factor at the first sample
    float share_step;       ///< change of the weight per sample
  };
  /// Correlates the noise of one of the factored_ lines.
  void correlate(std::complex<float>* noise, int line, const Span& span) const;
  void interpolate(const std::complex<float>* from, int line, std::complex<float>* target) const;

  int samples_;
  int lines_;
  UniformLines factored_;
  std::vector<Span> spans_;
  std::vector<BandedMatrix> factors_;  ///< by range
};

LineFilter::LineFilter(const ProbeOptics& optics)
    : samples_(optics.iq_samples()),
      lines_(optics.plan().acquisition().sticks_per_frame),
      factored_(UniformLines::needed(optics)) {
  const BeamGrid grid(optics.plan(), kFactorStep_m, kPi);  // its ranges alone are used
  factors_ = factors_by_range(LineCovariance(optics, factored_), grid, optics.threads());
  for (int i = 0; i < samples_; ++i) {
    const BeamGrid::Between at = grid.range_at((i + 0.5) * optics.iq_spacing_m());
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
  // In a dense scan the noise of the first lines is used for the lines that are factored.
  std::vector<Complex> copy;
  if (factored_.count < lines_) {
    copy.assign(frame, frame + static_cast<std::ptrdiff_t>(factored_.count) * samples_);
  }
  Complex* noise = copy.empty() ? frame : copy.data();
  // A line is a sum over the noise of the lines up to it: lines are overwritten from the last to
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
    const auto first = static_cast<float>(factor_weight(near, line, lag));
    const float change = static_cast<float>(factor_weight(far, line, lag)) - first;
    return Ramp{first + change * span.share, change * span.share_step};
  };
  const int count = span.last - span.first;
  float* target = parts(line);
  scale(target, weight(0), count);
  for (int lag = 1; lag <= std::min(line, std::max(near.band, far.band)); ++lag) {
    add_ramped(target, parts(line - lag), weight(lag), count);
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

std::vector<RangeKernels> kernels_by_angle(const IqField& field, const SpeckleKernels& kernels) {
  std::vector<RangeKernels> by_angle;
  for (int angle = 0; angle < kernels.angles(); ++angle) {
    by_angle.emplace_back(field.samples, field.spacing_m, kernels, angle);
  }
  return by_angle;
}

}  // namespace

double iq_bytes(const hw::AcquisitionPlan& plan) {
  return 1.0 * sizeof(Complex) * plan.sticks_per_volume() * plan.acquisition().samples_per_stick *
         iq_oversampling(plan);
}

IqField make_iq_field(const hw::AcquisitionPlan& plan) {
  const auto& acquisition = plan.acquisition();
  IqField field;
  field.frames = acquisition.frames_per_volume;
  field.lines = acquisition.sticks_per_frame;
  const int oversampling = iq_oversampling(plan);
  field.samples = acquisition.samples_per_stick * oversampling;
  field.spacing_m = plan.sample_spacing_m() / oversampling;
  field.values.resize(static_cast<std::size_t>(plan.sticks_per_volume()) *
                      static_cast<std::size_t>(field.samples));
  return field;
}

std::vector<float> unit_power_gaussian(double sigma_in_steps, int max_half) {
  constexpr double kCutSigmas = 3.035;  // exp(-kCutSigmas^2 / 2) = 0.01
  const int half = static_cast<int>(std::clamp<double>(kCutSigmas * sigma_in_steps, 0, max_half));
  std::vector<double> taps;
  double power = 0;
  for (int i = -half; i <= half; ++i) {
    const double tap = half == 0 ? 1 : std::exp(-0.5 * i * i / (sigma_in_steps * sigma_in_steps));
    taps.push_back(tap);
    power += tap * tap;
  }
  std::vector<float> unit;
  for (double tap : taps) unit.push_back(static_cast<float>(tap / std::sqrt(power)));
  return unit;
}

AxialKernels::AxialKernels(const std::vector<double>& sigmas_samples)
    : samples_(static_cast<int>(sigmas_samples.size())) {
  std::vector<std::vector<float>> taps;
  for (const double sigma : sigmas_samples) {
    taps.push_back(unit_power_gaussian(sigma, kMaxHalfPulse));
    half_ = std::max(half_, static_cast<int>(taps.back().size()) / 2);
  }
  weights_.assign(taps.size() * static_cast<std::size_t>(2 * half_ + 1), 0.0f);
  for (std::size_t i = 0; i < taps.size(); ++i) {
    const int half = static_cast<int>(taps[i].size()) / 2;
    for (int tap = -half; tap <= half; ++tap) {
      const auto row = static_cast<std::size_t>(tap + half_);
      weights_[row * taps.size() + i] = taps[i][static_cast<std::size_t>(tap + half)];
    }
  }
}

void fill_speckle(std::span<Complex> stick, std::uint64_t key, const AxialKernels& kernels) {
  const int count = static_cast<int>(stick.size()), half = kernels.half();
  if (count != kernels.samples()) throw std::invalid_argument("fill_speckle: a kernel a sample");
  // Noise extends beyond both ends of the stick, so that the filter has no edges.
  std::vector<Complex> noise(stick.size() + static_cast<std::size_t>(2 * half));
  fill_noise(parts_of(noise.data()), static_cast<int>(noise.size()), key);
  std::fill(stick.begin(), stick.end(), Complex(0));
  for (int tap = -half; tap <= half; ++tap) {
    add_weighted(
        parts_of(stick.data()), parts_of(noise.data() + tap + half), kernels.weights(tap), count);
  }
}

void filter_across_lines(IqField& field, const ProbeOptics& optics) {
  const LineFilter filter(optics);
  parallel_ranges(field.frames, optics.threads(), [&](int first, int last) {
    for (int frame = first; frame < last; ++frame) filter.apply(field.stick(frame, 0).data());
  });
}

void filter_across_frames(IqField& field, const ProbeOptics& optics) {
  const SpeckleKernels kernels(optics);
  if (kernels.count() == 1) return;
  const std::size_t frame = static_cast<std::size_t>(field.samples) * field.lines;
  const auto by_angle = kernels_by_angle(field, kernels);
  parallel_ranges(field.lines, optics.threads(), [&](int first, int last) {
    for (int line = first; line < last; ++line) {
      const auto angle = static_cast<std::size_t>(kernels.angle_of(optics.plan().theta_rad(line)));
      filter_line(field.stick(0, line).data(), field.frames, frame, by_angle[angle]);
    }
  });
}

IqField homogeneous_speckle(const ProbeOptics& optics, std::uint64_t seed) {
  IqField field = make_iq_field(optics.plan());
  const SpeckleLengths lengths(optics);
  std::vector<double> sigmas_samples;
  for (int i = 0; i < field.samples; ++i) {
    sigmas_samples.push_back(lengths.sigma_m((i + 0.5) * field.spacing_m) / field.spacing_m);
  }
  const AxialKernels kernels(sigmas_samples);
  parallel_ranges(optics.plan().sticks_per_volume(), optics.threads(), [&](int first, int last) {
    for (int i = first; i < last; ++i) {
      const int frame = i / field.lines, line = i % field.lines;
      const auto key = random_key(seed,
                                  RandomStream::speckle,
                                  static_cast<std::uint64_t>(frame),
                                  static_cast<std::uint64_t>(line));
      fill_speckle(field.stick(frame, line), key, kernels);
    }
  });
  filter_across_lines(field, optics);
  filter_across_frames(field, optics);
  return field;
}

void add_reflector(std::span<Complex> stick,
                   double spacing_m,
                   double range_m,
                   double amplitude,
                   const hw::AcquisitionPlan& plan) {
  const double sigma_m = sigma_of_fwhm(axial_fwhm_m(plan));
  const double cycles =
      2 * range_m * plan.probe().center_frequency_hz / plan.acquisition().sound_speed_m_s;
  const double phase = -2 * kPi * (cycles - std::floor(cycles));
  const std::complex<double> echo = std::polar(amplitude, phase);
  const int half_width = static_cast<int>(std::ceil(4 * sigma_m / spacing_m));
  const int middle = static_cast<int>(range_m / spacing_m);
  const int last = std::min(static_cast<int>(stick.size()) - 1, middle + half_width);
  for (int i = std::max(0, middle - half_width); i <= last; ++i) {
    const double offset = ((i + 0.5) * spacing_m - range_m) / sigma_m;
    stick[static_cast<std::size_t>(i)] += Complex(echo * std::exp(-0.5 * offset * offset));
  }
}

}  // namespace wobblebench::sim
