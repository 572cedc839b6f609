// Encoding of pictures by OpenImageIO.
#pragma once

#include <string>
#include <vector>

#include "bench/output/encoders.h"

namespace wobblebench::bench {

/// As Encoders::encode.
std::vector<char> encode_image(const Raster& raster, const std::string& extension);

}  // namespace wobblebench::bench
