#include "sim/echo_field.h"

#include <algorithm>
#include <cmath>

#include "sim/parallel.h"
#include "sim/point_spread.h"
#include "sim/random.h"

namespace wobblebench::sim {

namespace {

using Complex = std::complex<float>;

// Widest kernels worth their cost; wider ones occur only within a few millimetres of the face.
constexpr int kMaxHalfLines = 8;
constexpr int kMaxHalfFrames = 32;

/// Weighted sum of the `count` values around `centre`, `stride` apart. Taps beyond the ends are
/// left out and the rest scaled up, so that the edges of the field keep their power.
Complex filtered(const Complex* first,
                 int count,
                 std::size_t stride,
                 int centre,
                 const std::vector<float>& taps) {
  const int half = static_cast<int>(taps.size()) / 2;
  const int low = std::max(0, centre - half), high = std::min(count - 1, centre + half);
  Complex sum(0, 0);
  float power = 0;
  for (int i = low; i <= high; ++i) {
    const float tap = taps[static_cast<std::size_t>(i - centre + half)];
    sum += tap * first[static_cast<std::size_t>(i) * stride];
    power += tap * tap;
  }
  return high - low == 2 * half ? sum : sum / std::sqrt(power);
}

std::vector<Complex> convolved(std::span<const Complex> values, const std::vector<float>& taps) {
  const int count = static_cast<int>(values.size());
  std::vector<Complex> result(values.size());
  for (int i = 0; i < count; ++i) {
    result[static_cast<std::size_t>(i)] = filtered(values.data(), count, 1, i, taps);
  }
  return result;
}

}  // namespace

int iq_oversampling(const hw::AcquisitionPlan& plan) {
  const auto& acquisition = plan.acquisition();
  const double output_rate_hz = acquisition.sound_speed_m_s / (2 * plan.sample_spacing_m());
  const double band_hz = plan.probe().fractional_bandwidth * plan.probe().center_frequency_hz;
  // A Gaussian pulse is 29 dB down at 2.2 times its -6 dB band.
  return std::max(1, static_cast<int>(std::ceil(2.2 * band_hz / output_rate_hz)));
}

EchoField make_echo_field(const hw::AcquisitionPlan& plan) {
  const auto& acquisition = plan.acquisition();
  EchoField field;
  field.frames = acquisition.frames_per_volume;
  field.lines = acquisition.sticks_per_frame;
  const int oversampling = iq_oversampling(plan);
  field.samples = acquisition.samples_per_stick * oversampling;
  field.spacing_m = plan.sample_spacing_m() / oversampling;
  field.values.resize(static_cast<std::size_t>(plan.sticks_per_volume()) *
                      static_cast<std::size_t>(field.samples));
  return field;
}

void fill_speckle(std::span<Complex> stick, std::uint64_t key, double pulse_sigma_samples) {
  for (std::size_t i = 0; i < stick.size(); ++i) stick[i] = complex_normal(key, i);
  const auto smooth = convolved(stick, unit_power_gaussian(pulse_sigma_samples, kMaxHalfPulse));
  std::copy(smooth.begin(), smooth.end(), stick.begin());
}

void filter_across_lines(EchoField& field, const hw::AcquisitionPlan& plan, int threads) {
  const double sigma_m = sigma_of_fwhm(lateral_fwhm_m(plan));
  std::vector<std::vector<float>> taps;
  for (int i = 0; i < field.samples; ++i) {
    const double radius_m = plan.probe().radius_m + (i + 0.5) * field.spacing_m;
    const double step_m = radius_m * plan.theta_step_rad();
    taps.push_back(unit_power_gaussian(step_m > 0 ? sigma_m / step_m : 0, kMaxHalfLines));
  }
  parallel_ranges(field.frames, threads, [&](int first, int last) {
    std::vector<Complex> frame;
    for (int f = first; f < last; ++f) {
      Complex* values = field.stick(f, 0).data();
      const std::size_t stride = static_cast<std::size_t>(field.samples);
      frame.assign(values, values + stride * static_cast<std::size_t>(field.lines));
      for (int line = 0; line < field.lines; ++line) {
        for (std::size_t i = 0; i < stride; ++i) {
          if (taps[i].size() == 1) continue;
          values[line * stride + i] =
              filtered(frame.data() + i, field.lines, stride, line, taps[i]);
        }
      }
    }
  });
}

void filter_across_frames(EchoField& field, const hw::AcquisitionPlan& plan, int threads) {
  const std::size_t stride = static_cast<std::size_t>(field.samples);
  const std::size_t frame_stride = stride * static_cast<std::size_t>(field.lines);
  parallel_ranges(field.lines, threads, [&](int first, int last) {
    std::vector<Complex> column(static_cast<std::size_t>(field.frames));
    for (int line = first; line < last; ++line) {
      for (std::size_t i = 0; i < stride; ++i) {
        const double range_m = (static_cast<double>(i) + 0.5) * field.spacing_m;
        const double step_m = frame_distance_m(plan, line, range_m);
        const double sigma_m = sigma_of_fwhm(elevation_fwhm_m(plan, range_m));
        const auto taps = unit_power_gaussian(step_m > 0 ? sigma_m / step_m : 0, kMaxHalfFrames);
        if (taps.size() == 1) continue;
        Complex* values = field.values.data() + static_cast<std::size_t>(line) * stride + i;
        for (int f = 0; f < field.frames; ++f) {
          column[static_cast<std::size_t>(f)] = values[static_cast<std::size_t>(f) * frame_stride];
        }
        for (int f = 0; f < field.frames; ++f) {
          values[static_cast<std::size_t>(f) * frame_stride] =
              filtered(column.data(), field.frames, 1, f, taps);
        }
      }
    }
  });
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
  const int reach = static_cast<int>(std::ceil(4 * sigma_m / spacing_m));
  const int middle = static_cast<int>(range_m / spacing_m);
  const int last = std::min(static_cast<int>(stick.size()) - 1, middle + reach);
  for (int i = std::max(0, middle - reach); i <= last; ++i) {
    const double offset = ((i + 0.5) * spacing_m - range_m) / sigma_m;
    stick[static_cast<std::size_t>(i)] += Complex(echo * std::exp(-0.5 * offset * offset));
  }
}

}  // namespace wobblebench::sim
