// Complex numbers in inner loops.
#pragma once

#include <complex>

namespace wobblebench::sim {

/// Product without std::complex's checks for infinities.
inline std::complex<double> times(const std::complex<double>& a, const std::complex<double>& b) {
  return {a.real() * b.real() - a.imag() * b.imag(), a.real() * b.imag() + a.imag() * b.real()};
}

/// Real and imaginary parts in turn.
inline float* parts_of(std::complex<float>* values) {
  return reinterpret_cast<float*>(values);
}

}  // namespace wobblebench::sim
