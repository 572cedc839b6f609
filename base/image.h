// A picture in memory, of any pixel type.
#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>
#include <vector>

namespace wobblebench {

/// Row-major picture; row 0 is the top.
///
/// @code
/// Image<float> depth_m(640, 480, kNoSurface);
/// depth_m.at(320, 240) = 0.12f;  // column, row
/// float nearest_m = depth_m.at(320, 240);
/// for (const float z : depth_m.pixels) {
///   if (z < nearest_m) nearest_m = z;  // false for NaN
/// }
/// @endcode
template <class Pixel>
struct Image {
  int width = 0;
  int height = 0;
  std::vector<Pixel> pixels;

  Image() = default;
  Image(int w, int h, Pixel fill = {})
      : width(w),
        height(h),
        pixels(static_cast<std::size_t>(w) * static_cast<std::size_t>(h), fill) {}
  Pixel& at(int column, int row) {
    return pixels[static_cast<std::size_t>(row) * static_cast<std::size_t>(width) +
                  static_cast<std::size_t>(column)];
  }
  const Pixel& at(int column, int row) const { return const_cast<Image*>(this)->at(column, row); }
};

/// The same picture with pixels of another type.
template <class Pixel, class From>
Image<Pixel> converted(const Image<From>& image) {
  Image<Pixel> result(image.width, image.height);
  std::ranges::transform(
      image.pixels, result.pixels.begin(), [](const From& pixel) { return Pixel(pixel); });
  return result;
}

/// Depth of a pixel without a surface: NaN.
inline constexpr float kNoSurface = std::numeric_limits<float>::quiet_NaN();

}  // namespace wobblebench
