// What a pixel may be: from the least to the greatest of several pictures.
#pragma once

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/vec3.hpp>
#include <limits>
#include <utility>

#include "base/image.h"

namespace wobblebench::bench {

/// No surface lies behind all surfaces.
inline double as_span(double z_m) {
  return std::isnan(z_m) ? std::numeric_limits<double>::infinity() : z_m;
}
inline glm::dvec3 as_span(const glm::dvec3& colour) {
  return colour;
}

template <class Pixel>
class PixelSpans {
 public:
  explicit PixelSpans(const Image<Pixel>& first) : low_(first), high_(first) {
    for (Pixel& pixel : low_.pixels) pixel = as_span(pixel);
    high_ = low_;
  }
  void include(const Image<Pixel>& other) {
    for (std::size_t i = 0; i < low_.pixels.size(); ++i) {
      low_.pixels[i] = least(low_.pixels[i], as_span(other.pixels[i]));
      high_.pixels[i] = greatest(high_.pixels[i], as_span(other.pixels[i]));
    }
  }
  /// Anything.
  void include_all() {
    const double infinity = std::numeric_limits<double>::infinity();
    for (Pixel& pixel : low_.pixels) pixel = Pixel(-infinity);
    for (Pixel& pixel : high_.pixels) pixel = Pixel(infinity);
  }
  const Pixel& low(std::size_t i) const { return low_.pixels[i]; }
  const Pixel& high(std::size_t i) const { return high_.pixels[i]; }

 private:
  static double least(double a, double b) { return std::min(a, b); }
  static double greatest(double a, double b) { return std::max(a, b); }
  static glm::dvec3 least(const glm::dvec3& a, const glm::dvec3& b) { return glm::min(a, b); }
  static glm::dvec3 greatest(const glm::dvec3& a, const glm::dvec3& b) { return glm::max(a, b); }

  Image<Pixel> low_, high_;
};

}  // namespace wobblebench::bench
