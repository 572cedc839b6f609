#include "sim/beam/beam_pattern.h"

#include <cmath>

#include "sim/beam/point_spread.h"
#include "sim/math/fast_math.h"
#include "sim/math/simd.h"

namespace wobblebench::sim {

namespace {

/// Gauss-Legendre rule of 16 points on (-1, 1): the positive half of its abscissas, and weights
/// (Abramowitz and Stegun, table 25.4). Exact to 1e-6 for phases that change by up to kPanel_rad.
constexpr int kHalf = 8;
constexpr float kAbscissas[kHalf] = {0.0950125098f,
                                     0.2816035508f,
                                     0.4580167777f,
                                     0.6178762444f,
                                     0.7554044084f,
                                     0.8656312024f,
                                     0.9445750231f,
                                     0.9894009350f};
constexpr float kWeights[kHalf] = {0.1894506105f,
                                   0.1826034150f,
                                   0.1691565194f,
                                   0.1495959888f,
                                   0.1246289713f,
                                   0.0951585117f,
                                   0.0622535239f,
                                   0.0271524594f};
constexpr double kPanel_rad = 20;

/// A panel of the aperture, x from -1 to 1. Phase in cycles: (curvature x + slope) x + start. Phase
/// across an element, in radians: element + x * element_slope.
struct Panel {
  float curvature;
  float slope;
  float start;
  float element;
  float element_slope;
};

struct Sum {
  float re;
  float im;
};

WOBBLEBENCH_INLINE CosSin phasor(float cycles) {
  const float away = cycles < 0.0f ? -0.5f : 0.5f;
  return cos_sin_of_cycles(cycles - static_cast<float>(static_cast<std::int32_t>(cycles + away)));
}

/// sin(x) / x, with an error below 0.01 up to 0.6 pi, which elements of one wavelength do not
/// exceed; it stays small beyond.
WOBBLEBENCH_INLINE float directivity(float x) {
  const float q = x * x < 6.0f ? x * x * (1.0f / 6.0f) : 1.0f;
  return 1.0f - q * (1.0f - q * (0.3f - 0.043f * q));
}

/// Mean over the panel.
WOBBLEBENCH_SIMD Sum integral(const Panel& panel) {
  float re[kHalf], im[kHalf];
  for (int i = 0; i < kHalf; ++i) {
    const float x = kAbscissas[i];
    const CosSin ahead = phasor((panel.curvature * x + panel.slope) * x + panel.start);
    const CosSin behind = phasor((panel.curvature * x - panel.slope) * x + panel.start);
    const float weight_ahead = kWeights[i] * directivity(panel.element + x * panel.element_slope);
    const float weight_behind = kWeights[i] * directivity(panel.element - x * panel.element_slope);
    re[i] = weight_ahead * ahead.cosine + weight_behind * behind.cosine;
    im[i] = weight_ahead * ahead.sine + weight_behind * behind.sine;
  }
  Sum sum{0, 0};
  for (int i = 0; i < kHalf; ++i) {
    sum.re += re[i];
    sum.im += im[i];
  }
  return {0.5f * sum.re, 0.5f * sum.im};
}

double wavenumber(const hw::AcquisitionPlan& plan, double frequency_hz) {
  return 2 * kPi * frequency_hz / plan.acquisition().sound_speed_m_s;
}

}  // namespace

std::complex<double> aperture_response(const Aperture& aperture,
                                       double wavenumber_per_m,
                                       double range_m,
                                       double offset_m) {
  // Phase in cycles over the position on the aperture.
  const double curvature = -0.25 / kPi * wavenumber_per_m * (1 / range_m - 1 / aperture.focus_m);
  const double slope = 0.5 / kPi * wavenumber_per_m * offset_m / range_m;
  const double cycles =
      (std::abs(curvature) * 0.5 * aperture.width_m + std::abs(slope)) * aperture.width_m;
  const int panels = 1 + static_cast<int>(2 * kPi * cycles / kPanel_rad);
  const double half = 0.5 * aperture.width_m / panels;
  std::complex<double> sum = 0;
  for (int i = 0; i < panels; ++i) {
    const double middle = (2 * i + 1) * half - 0.5 * aperture.width_m;
    const double start = (curvature * middle + slope) * middle;
    const Sum part = integral({static_cast<float>(curvature * half * half),
                               static_cast<float>((2 * curvature * middle + slope) * half),
                               static_cast<float>(start - std::floor(start)),
                               static_cast<float>(aperture.element_phase_per_m * middle),
                               static_cast<float>(aperture.element_phase_per_m * half)});
    sum += std::complex<double>(static_cast<double>(part.re), static_cast<double>(part.im));
  }
  const double offset_phase = -0.5 * wavenumber_per_m * offset_m * offset_m / range_m;
  return sum / static_cast<double>(panels) * std::polar(1.0, offset_phase);
}

std::complex<double> lateral_response(const hw::AcquisitionPlan& plan,
                                      double frequency_hz,
                                      double range_m,
                                      double offset_m) {
  const auto& probe = plan.probe();
  const double k = wavenumber(plan, frequency_hz);
  // An element's angle to the direction of the stick grows by the face's curvature and with the
  // direction from the element to the axis.
  const double element_phase_per_m = 0.5 * k * probe.pitch_m * (1 / probe.radius_m + 1 / range_m);
  const Aperture transmit{transmit_aperture_m(plan), probe.transmit_focus_m, element_phase_per_m};
  const Aperture receive{receive_aperture_m(plan, range_m), range_m, element_phase_per_m};
  return aperture_response(transmit, k, range_m, offset_m) *
         aperture_response(receive, k, range_m, offset_m);
}

std::complex<double> elevation_response(const hw::AcquisitionPlan& plan,
                                        double frequency_hz,
                                        double range_m,
                                        double offset_m) {
  const Aperture height{plan.probe().element_height_m, plan.probe().elevation_focus_m};
  const std::complex<double> one_way =
      aperture_response(height, wavenumber(plan, frequency_hz), range_m, offset_m);
  return one_way * one_way;
}

}  // namespace wobblebench::sim
