#include "sim/losses/cone_kernels.h"

#include "sim/math/simd.h"

namespace wobblebench::sim {

WOBBLEBENCH_SIMD void locate_frames(int frame,
                                    int frames,
                                    float aside_m,
                                    const float* __restrict frames_per_m,
                                    int lines,
                                    std::int32_t* __restrict before,
                                    float* __restrict share) {
  const auto here = static_cast<float>(frame), last = static_cast<float>(frames - 1);
  const std::int32_t last_interval = frames - 2;
  for (int i = 0; i < lines; ++i) {
    const float at = here + aside_m * frames_per_m[i];
    const float least = at < 0.0f ? 0.0f : at;
    const float position = least > last ? last : least;
    const auto whole = static_cast<std::int32_t>(position);
    before[i] = whole > last_interval ? last_interval : whole;
    share[i] = position - static_cast<float>(before[i]);
  }
}

WOBBLEBENCH_SIMD void interpolate(const float* __restrict near,
                                  const float* __restrict far,
                                  const float* __restrict share,
                                  int count,
                                  float* __restrict row) {
  for (int i = 0; i < count; ++i) row[i] = (1.0f - share[i]) * near[i] + share[i] * far[i];
}

WOBBLEBENCH_SIMD void step_ways(const LossRows& rows,
                                float share,
                                const float* __restrict axis_gain,
                                const float* __restrict axis_nepers,
                                int lines,
                                float* __restrict relative,
                                float* __restrict nepers) {
  constexpr float kLeast = 1e-30f;
  const float* __restrict t0 = rows.near_transmitted;
  const float* __restrict d0 = rows.near_absorbed;
  const float* __restrict t1 = rows.far_transmitted;
  const float* __restrict d1 = rows.far_absorbed;
  const float rest = 1.0f - share;
  for (int i = 0; i < lines; ++i) {
    const float near = 1.0f / (rest * t0[i] + share * t0[i + 1]);
    const float far = rest * t1[i] + share * t1[i + 1];
    const float near_absorbed = rest * d0[i] + share * d0[i + 1];
    const float far_absorbed = rest * d1[i] + share * d1[i + 1];
    const float amplitude = relative[i] * (far * near) * axis_gain[i];
    relative[i] = amplitude < kLeast ? kLeast : amplitude;
    nepers[i] += far_absorbed / far - near_absorbed * near - axis_nepers[i];
  }
}

WOBBLEBENCH_SIMD void step_axis(const LossRows& rows,
                                int lines,
                                float* __restrict gain,
                                float* __restrict nepers) {
  const float* __restrict t0 = rows.near_transmitted;
  const float* __restrict d0 = rows.near_absorbed;
  const float* __restrict t1 = rows.far_transmitted;
  const float* __restrict d1 = rows.far_absorbed;
  for (int i = 0; i < lines; ++i) {
    gain[i] = t0[i] / t1[i];
    nepers[i] = d1[i] / t1[i] - d0[i] / t0[i];
  }
}

WOBBLEBENCH_SIMD void add_scaled(const float* __restrict values,
                                 float factor,
                                 int count,
                                 float* __restrict sum) {
  for (int i = 0; i < count; ++i) sum[i] += factor * values[i];
}

WOBBLEBENCH_SIMD void add_products(const float* __restrict values,
                                   const float* __restrict factors,
                                   int count,
                                   float* __restrict sum) {
  for (int i = 0; i < count; ++i) sum[i] += factors[i] * values[i];
}

WOBBLEBENCH_SIMD void weigh_beside(const Reaching& beside,
                                   const Reaching& stick,
                                   const float* __restrict share,
                                   int count,
                                   float* __restrict weight,
                                   float* __restrict own) {
  const float* __restrict amplitude = beside.amplitude;
  const float* __restrict material = beside.material;
  const float* __restrict own_amplitude = stick.amplitude;
  const float* __restrict own_material = stick.material;
  for (int i = 0; i < count; ++i) {
    const float counts = material[i] == own_material[i] ? share[i] : 0.0f;
    weight[i] = counts * amplitude[i] / own_amplitude[i];
    own[i] -= counts;
  }
}

WOBBLEBENCH_SIMD void add_wave(const PlaceRows& amplitude,
                               const PlaceRows& weight,
                               const float* __restrict part,
                               std::complex<double> wave,
                               int count,
                               WaveRow sum) {
  const double re = wave.real(), im = wave.imag();
  const float* __restrict first = amplitude.first;
  const float* __restrict second = amplitude.second;
  const float* __restrict own = amplitude.own;
  const float* __restrict of_first = weight.first;
  const float* __restrict of_second = weight.second;
  const float* __restrict of_own = weight.own;
  double* __restrict real = sum.real;
  double* __restrict imaginary = sum.imaginary;
  for (int i = 0; i < count; ++i) {
    const float there = of_first[i] * first[i] + of_second[i] * second[i] + of_own[i] * own[i];
    const double each = static_cast<double>(part[i] * there);
    real[i] += re * each;
    imaginary[i] += im * each;
  }
}

WOBBLEBENCH_SIMD void add_power(WaveRow transmit,
                                WaveRow receive,
                                int count,
                                double* __restrict power) {
  for (int i = 0; i < count; ++i) {
    const double sent =
        transmit.real[i] * transmit.real[i] + transmit.imaginary[i] * transmit.imaginary[i];
    const double received =
        receive.real[i] * receive.real[i] + receive.imaginary[i] * receive.imaginary[i];
    power[i] += sent * received;
  }
}

}  // namespace wobblebench::sim
