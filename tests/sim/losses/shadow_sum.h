// Echo power of tissue behind a half plane, by a sum over the waves and the sample points of a
// beam.
#pragma once

#include <algorithm>
#include <complex>
#include <numbers>

namespace wobblebench::sim {

/// Of transmit or receive, along one direction.
struct ShadowAperture {
  double width_m;
  double focus_m;
};

/// The half plane lies `plane_m` from the face, and passes `transparency` of the amplitude where it
/// covers; its edge is `aside_m` from the axis, the uncovered side positive.
struct ShadowPlane {
  double plane_m;
  double transparency;
  double aside_m;
};

/// Two-way amplitude, RMS over uniform tissue, at a range, relative to no half plane. Waves go
/// straight from 200 points of the aperture to 201 points of the beam, each with its phase
/// (Goodman, Introduction to Fourier Optics, 4.2).
inline double amplitude_behind(const ShadowAperture& transmit,
                               const ShadowAperture& receive,
                               double range_m,
                               double wavelength_m,
                               const ShadowPlane& plane) {
  constexpr int kWaves = 200, kPlaces = 201;
  const double reach_m = 4 * std::max(wavelength_m * range_m / receive.width_m,
                                      receive.width_m * std::abs(1 - range_m / receive.focus_m));
  double power = 0, free_power = 0;
  for (int p = 0; p < kPlaces; ++p) {
    const double place_m = reach_m * (2.0 * p / (kPlaces - 1) - 1);
    double through = 1, free = 1;
    for (const ShadowAperture& end : {transmit, receive}) {
      std::complex<double> left, all;
      for (int w = 0; w < kWaves; ++w) {
        const double from_m = ((w + 0.5) / kWaves - 0.5) * end.width_m;
        const double path_m =
            0.5 * from_m * from_m * (1 / range_m - 1 / end.focus_m) - from_m * place_m / range_m;
        const auto wave = std::polar(1.0, 2 * std::numbers::pi * path_m / wavelength_m);
        const double crossing_m = from_m + (place_m - from_m) * plane.plane_m / range_m;
        left += (crossing_m > -plane.aside_m ? 1 : plane.transparency) * wave;
        all += wave;
      }
      through *= std::norm(left);
      free *= std::norm(all);
    }
    power += through;
    free_power += free;
  }
  return std::sqrt(power / free_power);
}

}  // namespace wobblebench::sim
