// Vectorised loops: attributes for their functions, and elementary functions in single precision
// that compilers can vectorise (no branches, no tables, no calls).
// tests/sim/math/fast_math_test.cpp checks the stated errors.
#pragma once

#include <bit>
#include <complex>
#include <cstdint>

// WOBBLEBENCH_SIMD compiles a function three times (SSE2, AVX2, AVX-512) and selects one when the
// program is loaded. Products are never fused with sums (-ffp-contract=off) and each element is
// computed independently, so all three give the same bytes.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define WOBBLEBENCH_SIMD __attribute__((target_clones("default", "avx2", "arch=x86-64-v4")))
/// 1: functions may have a version with intrinsics, for instructions that compilers do not generate
/// from a C++ loop.
#define WOBBLEBENCH_INTRINSICS 1
#else
// Sanitizers intercept calls before the clone is selected.
#define WOBBLEBENCH_SIMD
#define WOBBLEBENCH_INTRINSICS 0
#endif

/// For functions called in vectorised loops: they must be inlined into each clone.
#define WOBBLEBENCH_INLINE [[gnu::always_inline]] inline

namespace wobblebench::sim {

/// Product without std::complex's checks for infinities.
inline std::complex<double> times(const std::complex<double>& a, const std::complex<double>& b) {
  return {a.real() * b.real() - a.imag() * b.imag(), a.real() * b.imag() + a.imag() * b.real()};
}

/// The values as floats: real and imaginary parts in turn.
inline float* parts_of(std::complex<float>* values) {
  return reinterpret_cast<float*>(values);
}
inline const float* parts_of(const std::complex<float>* values) {
  return reinterpret_cast<const float*>(values);
}

/// Magnitude; std::abs may be a call, which prevents vectorisation.
WOBBLEBENCH_INLINE float magnitude(float x) {
  return std::bit_cast<float>(std::bit_cast<std::uint32_t>(x) & 0x7fffffffu);
}

/// log2 of a positive normal number, within 3e-7 (absolute) near 1 and 3e-7 relative elsewhere.
WOBBLEBENCH_INLINE float fast_log2(float x) {
  // x = 2^e m with m in [1/sqrt 2, sqrt 2): log2 m is odd in s = (m - 1) / (m + 1).
  const std::uint32_t bits = std::bit_cast<std::uint32_t>(x);
  const std::int32_t e = static_cast<std::int32_t>(bits - 0x3f3504f3u) >> 23;
  const float m = std::bit_cast<float>(bits - (static_cast<std::uint32_t>(e) << 23));
  const float s = (m - 1.0f) / (m + 1.0f);
  const float s2 = s * s;
  const float series =
      2.88539008f + s2 * (0.961796694f + s2 * (0.577078016f + s2 * (0.412198583f + s2 * 0.32f)));
  return static_cast<float>(e) + s * series;
}

/// 1.5 * 2^23: a float added to it is rounded to the nearest integer, which is then in the low bits
/// of the sum. For magnitudes up to 2^22.
inline constexpr float kRoundToInteger = 12582912.0f;

/// e^x for x <= 88, within 2e-7 relative; 0 below -87.
WOBBLEBENCH_INLINE float fast_exp(float x) {
  const float clamped = x < -87.0f ? -87.0f : x;
  const float t = clamped * 1.44269504f;
  const float sum = t + kRoundToInteger;
  const float whole = sum - kRoundToInteger;
  const std::int32_t n =
      std::bit_cast<std::int32_t>(sum) - std::bit_cast<std::int32_t>(kRoundToInteger);
  // ln 2 in two parts, so that the remainder keeps its precision.
  const float r = (clamped - whole * 0.693359375f) - whole * -2.12194440e-4f;
  const float poly =
      1.0f +
      r * (1.0f + r * (0.5f + r * (0.166666667f + r * (0.0416666667f + r * (0.00833333333f +
                                                                            r * 0.00138888889f)))));
  const float scale = std::bit_cast<float>(static_cast<std::uint32_t>(n + 127) << 23);
  return x < -87.0f ? 0.0f : poly * scale;
}

struct CosSin {
  float cosine;
  float sine;
};

/// Cosine and sine of 2 pi u for |u| <= 2^20, within 3e-7.
WOBBLEBENCH_INLINE CosSin cos_sin_of_cycles(float u) {
  const float quarters = u * 4.0f;
  const float sum = quarters + kRoundToInteger;
  const std::int32_t q =
      std::bit_cast<std::int32_t>(sum) - std::bit_cast<std::int32_t>(kRoundToInteger);
  const float a = (quarters - (sum - kRoundToInteger)) * 1.57079633f;  // -pi/4 to pi/4
  const float a2 = a * a;
  const float s = a * (1.0f + a2 * (-0.166666667f + a2 * (0.00833333333f + a2 * -0.000198412698f)));
  const float c =
      1.0f + a2 * (-0.5f + a2 * (0.0416666667f + a2 * (-0.00138888889f + a2 * 2.48015873e-5f)));
  const bool swap = (q & 1) != 0;
  const float cosine = swap ? s : c;
  const float sine = swap ? c : s;
  return {((q + 1) & 2) != 0 ? -cosine : cosine, (q & 2) != 0 ? -sine : sine};
}

/// Density of the standard normal distribution relative to its peak, exp(-u^2 / 2), and its
/// cumulative distribution function, both at u.
struct Gaussian {
  float density;
  float distribution;
};

/// The distribution function is within 2e-7 (Abramowitz and Stegun, 7.1.26).
WOBBLEBENCH_INLINE Gaussian gaussian(float u) {
  const float x = (u < 0.0f ? -u : u) * 0.707106781f;
  const float density = fast_exp(-x * x);
  const float t = 1.0f / (1.0f + 0.3275911f * x);
  const float poly =
      t * (0.254829592f +
           t * (-0.284496736f + t * (1.421413741f + t * (-1.453152027f + t * 1.061405429f))));
  const float tail = 0.5f * poly * density;
  return {density, u < 0.0f ? tail : 1.0f - tail};
}

}  // namespace wobblebench::sim
