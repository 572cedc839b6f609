// Products of complex numbers in inner loops.
#pragma once

#include <complex>

namespace wobblebench::sim {

/// Without std::complex's checks for infinities.
inline std::complex<double> times(const std::complex<double>& a, const std::complex<double>& b) {
  return {a.real() * b.real() - a.imag() * b.imag(), a.real() * b.imag() + a.imag() * b.real()};
}

}  // namespace wobblebench::sim
