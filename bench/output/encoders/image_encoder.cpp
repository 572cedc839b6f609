#include "bench/output/encoders/image_encoder.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <stdexcept>

namespace wobblebench::bench {

std::vector<char> encode_image(const Raster& raster, const std::string& extension) {
  OIIO::ImageSpec spec(raster.width,
                       raster.height,
                       static_cast<int>(raster.channels.size()),
                       raster.bytes ? OIIO::TypeDesc::UINT8 : OIIO::TypeDesc::FLOAT);
  spec.channelnames = raster.channels;
  for (const auto& [name, value] : raster.attributes) spec.attribute(name, value);
  // In memory: OpenImageIO does not check the last flush of its own files.
  OIIO::Filesystem::IOVecOutput encoded;
  const std::string name = "picture" + extension;
  const auto output = OIIO::ImageOutput::create(name, &encoded);
  if (!output) throw std::runtime_error(OIIO::geterror());
  const bool whole = output->open(name, spec) &&
                     output->write_image(OIIO::TypeDesc::FLOAT, raster.values.data()) &&
                     output->close();
  if (!whole) throw std::runtime_error(output->geterror());
  const auto& bytes = encoded.buffer();
  return {bytes.begin(), bytes.end()};
}

}  // namespace wobblebench::bench
