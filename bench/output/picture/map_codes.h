// Maps of numbers as pages hold them: rounded to codes, compressed, and written in base64.
#pragma once

#include <cstdint>
#include <string>

#include "base/image.h"
#include "bench/output/document/document.h"
#include "bench/output/picture/error_picture.h"

namespace wobblebench::bench {

/// Rounding of the lengths of a map, unless they span more than 327 mm.
inline constexpr double kMapStep_mm = 0.005;

/// A layer of a MapView of lengths in metres, in millimetres; NaN, or not finite: no value. Its
/// colours go from
/// the least value to the greatest.
MapLayer length_layer(const std::string& name, const Image<float>& lengths_m);
/// Signed errors, whose colours go from -limit to limit.
MapLayer error_layer(const std::string& name, const Image<float>& errors_m, double limit_mm);

/// MapView::class_codes.
std::string class_codes(const Image<PixelClass>& classes);

/// Every n-th row and column.
template <class Pixel>
Image<Pixel> thinned(const Image<Pixel>& image, int n) {
  Image<Pixel> few((image.width + n - 1) / n, (image.height + n - 1) / n);
  for (int row = 0; row < few.height; ++row) {
    for (int column = 0; column < few.width; ++column) {
      few.at(column, row) = image.at(n * column, n * row);
    }
  }
  return few;
}

}  // namespace wobblebench::bench
