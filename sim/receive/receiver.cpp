#include "sim/receive/receiver.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "sim/math/fast_math.h"
#include "sim/math/random.h"

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

struct IqSample {
  float re, im;
};

/// IQ sample i of `iq`, an array of pairs of floats, with noise. `sample`: its number in the stick.
WOBBLEBENCH_INLINE IqSample with_noise(
    const float* iq, std::ptrdiff_t i, std::uint64_t key, std::uint32_t sample, float noise) {
  const ComplexNormal z = complex_normal(key, sample);
  return {iq[2 * i] + noise * z.re, iq[2 * i + 1] + noise * z.im};
}

WOBBLEBENCH_SIMD void add_noise_to(
    const float* __restrict iq, int count, std::uint64_t key, float noise, float* __restrict sum) {
  for (int i = 0; i < count; ++i) {
    const std::ptrdiff_t at = i;
    const IqSample noisy = with_noise(iq, at, key, static_cast<std::uint32_t>(i), noise);
    sum[2 * at] = noisy.re;
    sum[2 * at + 1] = noisy.im;
  }
}

/// |iq + noise| of `count` IQ samples, from sample `first` of the stick on.
WOBBLEBENCH_SIMD void noisy_envelope(const float* __restrict iq,
                                     int first,
                                     int count,
                                     std::uint64_t key,
                                     float noise,
                                     float* __restrict envelope) {
  for (int i = 0; i < count; ++i) {
    const auto [re, im] = with_noise(iq, i, key, static_cast<std::uint32_t>(first + i), noise);
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
      noise_(options.noise_db > kZeroAmplitude_db
                 ? static_cast<float>(amplitude_of_db(options.noise_db))
                 : 0.0f) {
  const int samples = plan.acquisition().samples_per_stick;
  const double full_scale = amplitude_of_db(options.full_scale_db);
  for (int k = 0; k < samples; ++k) {
    const double gain = time_gain(plan, options, plan.sample_range_m(k)) / full_scale;
    gain_.push_back(static_cast<float>(std::min(gain, kMostGain)));
  }
  const bool log = options.output == hw::SampleScale::log_compressed;
  const auto floor = static_cast<float>(amplitude_of_db(-options.dynamic_range_db));
  while (first_noisy_ < samples &&
         (noise_ == 0.0f ||
          (log &&
           noise_ * kMaxComplexNormal * gain_[static_cast<std::size_t>(first_noisy_)] < floor))) {
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
                         std::vector<std::complex<float>>& noisy) const {
  noisy.assign(iq.begin(), iq.end());
  if (noise_ == 0.0f) return;
  add_noise_to(
      parts_of(iq.data()), static_cast<int>(iq.size()), noise_key, noise_, parts_of(noisy.data()));
}

void Receiver::detect_block(
    const std::complex<float>* iq, std::uint64_t noise_key, int first, int count, float* samples) {
  const int each = oversampling_, from = first * each, iq_count = count * each;
  envelope_.resize(static_cast<std::size_t>(iq_count));
  const auto* parts = parts_of(iq + from);
  if (noise_ > 0) {
    noisy_envelope(parts, from, iq_count, noise_key, noise_, envelope_.data());
  } else {
    clean_envelope(parts, iq_count, envelope_.data());
  }
  (options_.low_pass ? average : take_middle)(envelope_.data(), count, each, samples);
  apply_gain(gain_.data() + first, count, samples);
  if (options_.output == hw::SampleScale::linear_envelope) return;
  compress(count, static_cast<float>(kOctave_db / options_.dynamic_range_db), samples);
}

}  // namespace wobblebench::sim
