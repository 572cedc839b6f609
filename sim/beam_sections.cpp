#include "sim/beam_sections.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstddef>

namespace wobblebench::sim {

namespace {

using Complex = std::complex<float>;

constexpr float kLargest = 32767;

std::uint32_t pack(const Complex& value, float per_fraction) {
  const auto half = [&](float x) {
    return static_cast<std::uint32_t>(static_cast<std::int32_t>(std::lround(x * per_fraction))) &
           0xffffu;
  };
  return half(value.real()) | half(value.imag()) << 16;
}

}  // namespace

BeamSections::BeamSections(const BeamTable& table) {
  const auto columns = static_cast<std::size_t>(table.columns());
  words_.reserve(2 * columns * columns * static_cast<std::size_t>(table.rows()));
  for (int row = 0; row < table.rows(); ++row) add_row(table, row);
}

void BeamSections::add_row(const BeamTable& table, int row) {
  const int columns = table.columns();
  const auto value = [&](const BeamTable::Direction& direction, int column, std::ptrdiff_t part) {
    const std::ptrdiff_t place = static_cast<std::ptrdiff_t>(row) * columns + column;
    const float* at = direction.values.data() + 4 * place + 2 * part;
    return Complex(at[0], at[1]);
  };
  std::vector<Complex> level, colour;
  float largest = 0;
  for (int u = 0; u < columns; ++u) {
    for (int v = 0; v < columns; ++v) {
      const Complex level_u = value(table.lateral(), u, 0), colour_u = value(table.lateral(), u, 1);
      const Complex level_v = value(table.elevation(), v, 0);
      level.push_back(level_u * level_v);
      colour.push_back(level_u * value(table.elevation(), v, 1) + colour_u * level_v);
      largest = std::max({largest, std::abs(level.back()), std::abs(colour.back())});
    }
  }
  for (std::size_t i = 0; i < level.size(); ++i) {
    words_.push_back(pack(level[i], kLargest / largest));
    words_.push_back(pack(colour[i], kLargest / largest));
  }
  scale_.push_back(largest / kLargest);
}

}  // namespace wobblebench::sim
