#include "bench/output/picture/colour_map.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <span>

namespace wobblebench::bench {

namespace {

/// Linear between anchors at equal distances.
glm::vec3 between(std::span<const std::uint32_t> anchors, double share) {
  const double at = std::clamp(share, 0.0, 1.0) * static_cast<double>(anchors.size() - 1);
  const std::size_t low = std::min(static_cast<std::size_t>(at), anchors.size() - 2);
  const auto part = static_cast<float>(at - static_cast<double>(low));
  return (1 - part) * display_colour(anchors[low]) + part * display_colour(anchors[low + 1]);
}

}  // namespace

glm::vec3 display_colour(std::uint32_t rgb) {
  return glm::vec3((rgb >> 16) & 255, (rgb >> 8) & 255, rgb & 255) / 255.0f;
}

std::string html_colour(std::uint32_t rgb) {
  std::array<char, 8> text{};
  std::snprintf(text.data(), text.size(), "#%06x", static_cast<unsigned>(rgb & 0xffffff));
  return text.data();
}

glm::vec3 diverging(double share) {
  static constexpr std::array<std::uint32_t, 5> anchors = {
      0x1a4b9c, 0x6fa8dc, 0xf7f7f7, 0xf0906a, 0xb2182b};
  return between(anchors, share);
}

glm::vec3 warm(double share) {
  static constexpr std::array<std::uint32_t, 5> anchors = {
      0x000000, 0x4a2a17, 0xa86a3d, 0xe8b47f, 0xfff6e5};
  return between(anchors, share);
}

glm::vec3 black_to_white(double share) {
  return glm::vec3(static_cast<float>(std::clamp(share, 0.0, 1.0)));
}

Picture3 coloured(
    const Image<float>& values, double low, double high, ColourMap map, const glm::vec3& none) {
  Picture3 picture(values.width, values.height, none);
  for (std::size_t i = 0; i < values.pixels.size(); ++i) {
    const auto value = static_cast<double>(values.pixels[i]);
    if (std::isfinite(value)) picture.pixels[i] = map((value - low) / (high - low));
  }
  return picture;
}

Picture3 grey(const Image<float>& values) {
  Picture3 picture(values.width, values.height);
  std::ranges::transform(
      values.pixels, picture.pixels.begin(), [](float value) { return glm::vec3(value); });
  return picture;
}

}  // namespace wobblebench::bench
