#include "sim/receive/receiver.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "sim/math/fast_math.h"
#include "sim/math/random.h"
#include "sim/optics/pulse_band.h"
#include "sim/speckle/iq_field.h"

namespace wobblebench::sim {

namespace {

/// Output samples that are skipped together where there is neither echo nor visible noise.
constexpr int kBlock = 64;
/// Smallest argument of the logarithm, 380 dB below full scale: a normal number.
constexpr float kSmallestAmplitude = 1e-19f;
/// Upper bound of the gain. An amplitude that it does not lift to full scale is zero, and the bound
/// is far from the largest float. Options allow 4900 dB (20 MHz, 3 dB/cm/MHz, 40 cm, full scale at
/// -100 dB).
const double kMostGain = amplitude_of_db(hw::kMostGain_db);

/// `count` complex normal numbers, those of the samples from `first` on.
WOBBLEBENCH_SIMD void fill_white_noise(std::uint64_t key,
                                       int first,
                                       int count,
                                       float* __restrict white) {
  for (int i = 0; i < count; ++i) {
    const ComplexNormal z = complex_normal(key, static_cast<std::uint32_t>(first + i));
    const std::ptrdiff_t at = 2 * static_cast<std::ptrdiff_t>(i);
    white[at] = z.re;
    white[at + 1] = z.im;
  }
}

/// sum[i] += tap * values[i].
WOBBLEBENCH_SIMD void add_scaled(const float* __restrict values,
                                 float tap,
                                 int count,
                                 float* __restrict sum) {
  for (int i = 0; i < count; ++i) sum[i] += tap * values[i];
}

/// |iq + noise| of `count` IQ samples.
WOBBLEBENCH_SIMD void noisy_envelope(const float* __restrict iq,
                                     const float* __restrict noise,
                                     int count,
                                     float* __restrict envelope) {
  for (int i = 0; i < count; ++i) {
    const std::ptrdiff_t at = 2 * static_cast<std::ptrdiff_t>(i);
    const float re = iq[at] + noise[at], im = iq[at + 1] + noise[at + 1];
    envelope[i] = std::sqrt(re * re + im * im);
  }
}

WOBBLEBENCH_SIMD void clean_envelope(const float* __restrict iq,
                                     int count,
                                     float* __restrict envelope) {
  for (int i = 0; i < count; ++i) {
    const std::ptrdiff_t at = 2 * static_cast<std::ptrdiff_t>(i);
    envelope[i] = std::sqrt(iq[at] * iq[at] + iq[at + 1] * iq[at + 1]);
  }
}

/// Low-pass: the mean of `each` IQ samples for each output sample.
WOBBLEBENCH_SIMD void average(const float* __restrict envelope,
                              std::ptrdiff_t count,
                              std::ptrdiff_t each,
                              float* __restrict samples) {
  if (each == 2) {  // the usual oversampling; this loop is vectorised
    for (std::ptrdiff_t k = 0; k < count; ++k) {
      samples[k] = 0.5f * (envelope[2 * k] + envelope[2 * k + 1]);
    }
    return;
  }
  for (std::ptrdiff_t k = 0; k < count; ++k) {
    float sum = 0;
    for (std::ptrdiff_t i = k * each; i < (k + 1) * each; ++i) sum += envelope[i];
    samples[k] = sum / static_cast<float>(each);
  }
}

/// Decimation without low-pass: the middle one of `each` IQ samples.
void take_middle(const float* envelope, std::ptrdiff_t count, std::ptrdiff_t each, float* samples) {
  for (std::ptrdiff_t k = 0; k < count; ++k) samples[k] = envelope[k * each + each / 2];
}

/// Saturates at the largest float: a sample is always finite.
WOBBLEBENCH_SIMD void apply_gain(const float* __restrict gain,
                                 int count,
                                 float* __restrict samples) {
  constexpr float kLargest = std::numeric_limits<float>::max();
  for (int k = 0; k < count; ++k) {
    const float amplified = samples[k] * gain[k];
    samples[k] = amplified < kLargest ? amplified : kLargest;
  }
}

/// `per_octave`: change of the sample value for each doubling of the amplitude.
WOBBLEBENCH_SIMD void compress(int count, float per_octave, float* samples) {
  for (int k = 0; k < count; ++k) {
    const float amplitude = samples[k];
    const float value =
        1.0f +
        per_octave * fast_log2(amplitude < kSmallestAmplitude ? kSmallestAmplitude : amplitude);
    const float positive = value < 0.0f ? 0.0f : value;
    samples[k] = positive > 1.0f ? 1.0f : positive;
  }
}

/// Filter that gives white noise of unit power the pulse's band and the RMS amplitude of the
/// options; empty without noise.
std::vector<float> noise_filter(const hw::AcquisitionPlan& plan,
                                const SimulationOptions& options,
                                int oversampling) {
  if (options.noise_db <= kZeroAmplitude_db) return {};
  const double spacing_m = plan.sample_spacing_m() / oversampling;
  auto taps = unit_power_gaussian(sigma_of_fwhm(axial_fwhm_m(plan)) / spacing_m, kMaxHalfPulse);
  const auto rms = static_cast<float>(amplitude_of_db(options.noise_db));
  for (float& tap : taps) tap *= rms;
  return taps;
}

/// A factor of 2 in amplitude.
const double kOctave_db = 20 * std::log10(2.0);

}  // namespace

double time_gain(const hw::AcquisitionPlan& plan,
                 const SimulationOptions& options,
                 double range_m) {
  constexpr double kCentimetre = 1e-2;
  return amplitude_of_db(2 * options.tgc_db_per_cm_mhz * plan.probe().center_frequency_hz /
                         kMegahertz * range_m / kCentimetre);
}

double largest_noise(const hw::AcquisitionPlan& plan,
                     const SimulationOptions& options,
                     int oversampling) {
  const std::vector<float> taps = noise_filter(plan, options, oversampling);
  return static_cast<double>(kMaxComplexNormal) * std::accumulate(taps.begin(), taps.end(), 0.0);
}

double visible_amplitude(const hw::AcquisitionPlan& plan, const SimulationOptions& options) {
  constexpr double kInvisible_db = 20;  ///< below the noise or the dynamic range
  if (options.noise_db > kZeroAmplitude_db) {
    return amplitude_of_db(options.noise_db - kInvisible_db);
  }
  if (options.output == hw::SampleScale::linear_envelope) return 0;
  const double invisible_db = options.full_scale_db - options.dynamic_range_db - kInvisible_db;
  return amplitude_of_db(invisible_db) / time_gain(plan, options, plan.acquisition().depth_m);
}

float log_compressed(double amplitude, const SimulationOptions& options) {
  if (!(amplitude > 0)) return 0;
  const double db = 20 * std::log10(amplitude) - options.full_scale_db;
  return static_cast<float>(std::clamp(1 + db / options.dynamic_range_db, 0.0, 1.0));
}

Receiver::Receiver(const hw::AcquisitionPlan& plan,
                   const SimulationOptions& options,
                   int oversampling)
    : options_(options),
      oversampling_(oversampling),
      noise_filter_(noise_filter(plan, options, oversampling)) {
  const int samples = plan.acquisition().samples_per_stick;
  const double full_scale = amplitude_of_db(options.full_scale_db);
  for (int k = 0; k < samples; ++k) {
    const double gain = time_gain(plan, options, plan.sample_range_m(k)) / full_scale;
    gain_.push_back(static_cast<float>(std::min(gain, kMostGain)));
  }
  const bool log = options.output == hw::SampleScale::log_compressed;
  const auto floor = static_cast<float>(amplitude_of_db(-options.dynamic_range_db));
  const auto most_noise = static_cast<float>(largest_noise(plan, options, oversampling));
  while (first_noisy_ < samples &&
         (noise_filter_.empty() ||
          (log && most_noise * gain_[static_cast<std::size_t>(first_noisy_)] < floor))) {
    ++first_noisy_;
  }
}

void Receiver::detect(std::span<const std::complex<float>> iq,
                      std::uint64_t noise_key,
                      std::span<float> samples) {
  const int count = static_cast<int>(samples.size());
  for (int first = 0; first < count; first += kBlock) {
    const int block = std::min(kBlock, count - first);
    const auto from = iq.begin() + static_cast<std::ptrdiff_t>(first) * oversampling_;
    const bool skip = first + block <= first_noisy_ &&
                      std::all_of(from,
                                  from + static_cast<std::ptrdiff_t>(block) * oversampling_,
                                  [](auto z) { return z == std::complex<float>(0); });
    if (skip) {
      std::fill_n(samples.begin() + first, block, 0.0f);
    } else {
      detect_block(iq.data(), noise_key, first, block, samples.data() + first);
    }
  }
}

void Receiver::add_noise(std::span<const std::complex<float>> iq,
                         std::uint64_t noise_key,
                         std::vector<std::complex<float>>& noisy) {
  noisy.assign(iq.begin(), iq.end());
  if (noise_filter_.empty()) return;
  const int count = static_cast<int>(iq.size());
  add_scaled(noise(noise_key, 0, count), 1, 2 * count, parts_of(noisy.data()));
}

const float* Receiver::noise(std::uint64_t key, int first, int count) {
  const int taps = static_cast<int>(noise_filter_.size()), white = count + taps - 1;
  white_noise_.resize(2 * static_cast<std::size_t>(white));
  fill_white_noise(key, first - taps / 2, white, white_noise_.data());
  noise_.assign(2 * static_cast<std::size_t>(count), 0.0f);
  for (int tap = 0; tap < taps; ++tap) {
    add_scaled(white_noise_.data() + static_cast<std::ptrdiff_t>(2 * tap),
               noise_filter_[static_cast<std::size_t>(tap)],
               2 * count,
               noise_.data());
  }
  return noise_.data();
}

void Receiver::detect_block(
    const std::complex<float>* iq, std::uint64_t noise_key, int first, int count, float* samples) {
  const int each = oversampling_, from = first * each, iq_count = count * each;
  envelope_.resize(static_cast<std::size_t>(iq_count));
  const auto* parts = parts_of(iq + from);
  if (!noise_filter_.empty()) {
    noisy_envelope(parts, noise(noise_key, from, iq_count), iq_count, envelope_.data());
  } else {
    clean_envelope(parts, iq_count, envelope_.data());
  }
  (options_.low_pass ? average : take_middle)(envelope_.data(), count, each, samples);
  apply_gain(gain_.data() + first, count, samples);
  if (options_.output == hw::SampleScale::linear_envelope) return;
  compress(count, static_cast<float>(kOctave_db / options_.dynamic_range_db), samples);
}

}  // namespace wobblebench::sim
