#include "bench/output/picture/map_codes.h"

#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "base/units.h"
#include "bench/output/page/page_text.h"

namespace wobblebench::bench {

namespace {

constexpr unsigned kNoValue = 65535;

struct Range {
  double low_mm = 0;
  double high_mm = 0;
};

Range range_of(const Image<float>& lengths_m) {
  Range range{INFINITY, -INFINITY};
  for (const float length_m : lengths_m.pixels) {
    if (!std::isfinite(length_m)) continue;
    const double mm = static_cast<double>(length_m) / kMillimetre;
    range = {std::min(range.low_mm, mm), std::max(range.high_mm, mm)};
  }
  return range.low_mm > range.high_mm ? Range{} : range;
}

std::string compressed(const std::string& bytes) {
  uLongf size = compressBound(static_cast<uLong>(bytes.size()));
  std::string packed(size, '\0');
  const int failed = compress2(reinterpret_cast<Bytef*>(packed.data()),
                               &size,
                               reinterpret_cast<const Bytef*>(bytes.data()),
                               static_cast<uLong>(bytes.size()),
                               Z_BEST_SPEED);
  if (failed != Z_OK) throw std::runtime_error("zlib: error " + std::to_string(failed));
  packed.resize(size);
  return packed;
}

std::string codes_of(const Image<float>& lengths_m, double first_mm, double step_mm) {
  std::string bytes;
  bytes.reserve(2 * lengths_m.pixels.size());
  for (const float length_m : lengths_m.pixels) {
    const double mm = static_cast<double>(length_m) / kMillimetre;
    const auto code = std::isfinite(length_m)
                          ? static_cast<unsigned>(std::lrint((mm - first_mm) / step_mm))
                          : kNoValue;
    bytes += static_cast<char>(code & 255);
    bytes += static_cast<char>(code >> 8);
  }
  return base64(compressed(bytes));
}

}  // namespace

MapLayer length_layer(const std::string& name, const Image<float>& lengths_m) {
  const Range range = range_of(lengths_m);
  const double step_mm = std::max(kMapStep_mm, (range.high_mm - range.low_mm) / (kNoValue - 1));
  return {.name = name,
          .unit = "mm",
          .low = range.low_mm,
          .high = range.high_mm > range.low_mm ? range.high_mm : range.low_mm + 1,
          .first = range.low_mm,
          .step = step_mm,
          .codes = codes_of(lengths_m, range.low_mm, step_mm)};
}

MapLayer error_layer(const std::string& name, const Image<float>& errors_m, double limit_mm) {
  MapLayer layer = length_layer(name, errors_m);
  layer.colours = MapLayer::Colours::diverging;
  layer.low = -limit_mm;
  layer.high = limit_mm;
  return layer;
}

std::string class_codes(const Image<PixelClass>& classes) {
  std::string bytes;
  bytes.reserve(classes.pixels.size());
  for (const PixelClass of : classes.pixels) bytes += static_cast<char>(of);
  return base64(compressed(bytes));
}

}  // namespace wobblebench::bench
