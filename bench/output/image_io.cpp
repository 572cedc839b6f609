#include "bench/output/image_io.h"

#include <cmath>
#include <stdexcept>

#include "base/file.h"
#include "bench/output/encoders.h"

namespace wobblebench::bench {

namespace {

void write(const std::filesystem::path& path, const Raster& raster) {
  std::vector<char> bytes;
  try {
    bytes = encoders().encode(raster, path.extension().string());
  } catch (const std::exception& error) {
    throw std::runtime_error(path.string() + ": " + error.what());
  }
  write_file(path, {bytes.data(), bytes.size()});
}

}  // namespace

float encoded(float light) {
  return light <= 0.0031308f ? 12.92f * light : 1.055f * std::pow(light, 1 / 2.4f) - 0.055f;
}

void write_png(const std::filesystem::path& path, const Image<glm::vec3>& image, Values meaning) {
  Raster raster{
      image.width, image.height, {"R", "G", "B"}, true, {}, {{"oiio:ColorSpace", "sRGB"}}};
  raster.values.reserve(image.pixels.size() * 3);
  for (const glm::vec3& rgb : image.pixels) {
    raster.values.insert(raster.values.end(), {rgb.r, rgb.g, rgb.b});
  }
  if (meaning == Values::light) {
    for (float& value : raster.values) value = encoded(value);
  }
  write(path, raster);
}

void write_exr_mm(const std::filesystem::path& path, const std::vector<NamedMap>& maps_m) {
  const auto& first = *maps_m.at(0).second;
  // The library writes the hour otherwise, and equal results would differ.
  Raster raster{first.width,
                first.height,
                {},
                false,
                {},
                {{"ImageDescription", "linear: lengths in millimetres; NaN: no value"},
                 {"DateTime", "0000:00:00 00:00:00"}}};
  for (const auto& [name, map] : maps_m) raster.channels.push_back(name);
  raster.values.reserve(first.pixels.size() * maps_m.size());
  for (std::size_t i = 0; i < first.pixels.size(); ++i) {
    for (const auto& [name, map] : maps_m) raster.values.push_back(1000.0f * map->pixels.at(i));
  }
  write(path, raster);
}

}  // namespace wobblebench::bench
