#include "sim/speckle/iq_field.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "base/parallel.h"
#include "sim/math/complex.h"
#include "sim/math/random.h"
#include "sim/optics/point_spread.h"
#include "sim/speckle/line_filter.h"
#include "sim/speckle/speckle_kernels.h"
#include "sim/speckle/speckle_length.h"

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

/// Symmetric kernels across frames, one for each range, stored tap by tap so that loops run along
/// the stick.
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
  /// End of the samples at which the tap is not 0.
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

void filter_across_lines(IqField& field,
                         const hw::AcquisitionPlan& plan,
                         const SimulationOptions& options) {
  const LineFilter filter(plan, options, field.samples, field.spacing_m);
  parallel_ranges(field.frames, options.threads, [&](int first, int last) {
    for (int frame = first; frame < last; ++frame) filter.apply(field.stick(frame, 0).data());
  });
}

void filter_across_frames(IqField& field,
                          const hw::AcquisitionPlan& plan,
                          const SimulationOptions& options) {
  const SpeckleKernels kernels(plan, options);
  if (kernels.count() == 1) return;
  const std::size_t frame = static_cast<std::size_t>(field.samples) * field.lines;
  const auto by_angle = kernels_by_angle(field, kernels);
  parallel_ranges(field.lines, options.threads, [&](int first, int last) {
    for (int line = first; line < last; ++line) {
      const auto angle = static_cast<std::size_t>(kernels.angle_of(plan.theta_rad(line)));
      filter_line(field.stick(0, line).data(), field.frames, frame, by_angle[angle]);
    }
  });
}

IqField homogeneous_speckle(const hw::AcquisitionPlan& plan, const SimulationOptions& options) {
  IqField field = make_iq_field(plan);
  const SpeckleLengths lengths(plan, options);
  std::vector<double> sigmas_samples;
  for (int i = 0; i < field.samples; ++i) {
    sigmas_samples.push_back(lengths.sigma_m((i + 0.5) * field.spacing_m) / field.spacing_m);
  }
  const AxialKernels kernels(sigmas_samples);
  parallel_ranges(plan.sticks_per_volume(), options.threads, [&](int first, int last) {
    for (int i = first; i < last; ++i) {
      const int frame = i / field.lines, line = i % field.lines;
      const auto key = random_key(options.seed,
                                  RandomStream::speckle,
                                  static_cast<std::uint64_t>(frame),
                                  static_cast<std::uint64_t>(line));
      fill_speckle(field.stick(frame, line), key, kernels);
    }
  });
  filter_across_lines(field, plan, options);
  filter_across_frames(field, plan, options);
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
