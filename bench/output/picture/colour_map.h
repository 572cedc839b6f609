// Colours of numbers: the maps of errors and depths, right for any colour vision.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <string>

#include "base/image.h"

namespace wobblebench::bench {

using Picture3 = Image<glm::vec3>;

/// Display values of a number between the low end, 0, and the high end, 1; beyond them, that of the
/// end.
using ColourMap = glm::vec3 (*)(double share);

/// Blue, white in the middle, red: for signed values.
glm::vec3 diverging(double share);
/// Black, brown, cream, rising in lightness: as scanners tint volume pictures.
glm::vec3 warm(double share);

glm::vec3 black_to_white(double share);

/// 0xRRGGBB as display values, and as HTML writes it, "#rrggbb".
glm::vec3 display_colour(std::uint32_t rgb);
std::string html_colour(std::uint32_t rgb);

/// `low` has the map's first colour, `high` its last; values that are not finite have `none`.
Picture3 coloured(
    const Image<float>& values, double low, double high, ColourMap map, const glm::vec3& none);

/// Grey levels of values in [0, 1].
Picture3 grey(const Image<float>& values);

}  // namespace wobblebench::bench
