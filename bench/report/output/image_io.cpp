#include "bench/report/output/image_io.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <cmath>
#include <stdexcept>
#include <string_view>

#include "base/write_file.h"

namespace wobblebench::bench {

namespace {

/// Writes interleaved floats; the file's format follows from its extension. Encoded in memory,
/// because OpenImageIO does not check the last flush of its own files.
void write(const std::filesystem::path& path,
           const OIIO::ImageSpec& spec,
           const std::vector<float>& values) {
  OIIO::Filesystem::IOVecOutput encoded;
  const auto output = OIIO::ImageOutput::create(path.string(), &encoded);
  if (!output) throw std::runtime_error(path.string() + ": " + OIIO::geterror());
  const bool whole = output->open(path.string(), spec) &&
                     output->write_image(OIIO::TypeDesc::FLOAT, values.data()) && output->close();
  if (!whole) throw std::runtime_error(path.string() + ": " + output->geterror());
  const auto& bytes = encoded.buffer();
  write_file(path, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

}  // namespace

float encoded(float light) {
  return light <= 0.0031308f ? 12.92f * light : 1.055f * std::pow(light, 1 / 2.4f) - 0.055f;
}

void write_png(const std::filesystem::path& path, const Image<glm::vec3>& image, Values meaning) {
  std::vector<float> values;
  values.reserve(image.pixels.size() * 3);
  for (const glm::vec3& rgb : image.pixels) values.insert(values.end(), {rgb.r, rgb.g, rgb.b});
  if (meaning == Values::light) {
    for (float& value : values) value = encoded(value);
  }
  OIIO::ImageSpec spec(image.width, image.height, 3, OIIO::TypeDesc::UINT8);
  spec.attribute("oiio:ColorSpace", "sRGB");
  write(path, spec, values);
}

void write_exr_mm(const std::filesystem::path& path, const std::vector<NamedMap>& maps_m) {
  const auto& first = *maps_m.at(0).second;
  const int channels = static_cast<int>(maps_m.size());
  OIIO::ImageSpec spec(first.width, first.height, channels, OIIO::TypeDesc::FLOAT);
  spec.channelnames.clear();
  for (const auto& [name, map] : maps_m) spec.channelnames.push_back(name);
  spec.attribute("ImageDescription", "linear: lengths in millimetres; NaN: no value");
  // The library writes the hour otherwise, and equal results would differ.
  spec.attribute("DateTime", "0000:00:00 00:00:00");
  std::vector<float> values;
  values.reserve(first.pixels.size() * maps_m.size());
  for (std::size_t i = 0; i < first.pixels.size(); ++i) {
    for (const auto& [name, map] : maps_m) values.push_back(1000.0f * map->pixels.at(i));
  }
  write(path, spec, values);
}

}  // namespace wobblebench::bench
