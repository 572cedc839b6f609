#include "sim/aperture/cone_kernels.h"

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
  for (int i = 0; i < count; ++i) row[i] = near[i] + share[i] * (far[i] - near[i]);
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
  for (int i = 0; i < lines; ++i) {
    const float near = 1.0f / (t0[i] + share * (t0[i + 1] - t0[i]));
    const float far = t1[i] + share * (t1[i + 1] - t1[i]);
    const float near_absorbed = d0[i] + share * (d0[i + 1] - d0[i]);
    const float far_absorbed = d1[i] + share * (d1[i + 1] - d1[i]);
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

}  // namespace wobblebench::sim
