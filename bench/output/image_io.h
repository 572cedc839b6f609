// Writing of pictures (PNG) and maps (EXR), by OpenImageIO.
#pragma once

#include <filesystem>
#include <glm/vec3.hpp>
#include <string>
#include <utility>
#include <vector>

#include "render/picture.h"

namespace wobblebench::bench {

/// What the values of a picture, in [0, 1], are: colours as sRGB (IEC 61966-2-1) encodes them, or
/// light, which is encoded so.
enum class Values { display, light };

/// sRGB's transfer function (IEC 61966-2-1).
float encoded(float light);

/// 8-bit RGB PNG in sRGB, which the file says. Throws std::runtime_error "PATH: reason".
void write_png(const std::filesystem::path& path,
               const Image<glm::vec3>& image,
               Values values = Values::display);

/// Float EXR with one named channel a map, linear; lengths are converted from metres to
/// millimetres, pixels without a value are NaN. Throws std::runtime_error "PATH: reason".
using NamedMap = std::pair<std::string, const Image<float>*>;
void write_exr_mm(const std::filesystem::path& path, const std::vector<NamedMap>& maps_m);

}  // namespace wobblebench::bench
