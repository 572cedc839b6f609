// Any outline, its corners on a coarse lattice, where repeated and straight ones are frequent: it
// is refused, or covered by triangles as often as it winds about a point.
#include <cstdint>
#include <cstdlib>
#include <glm/vec3.hpp>
#include <span>
#include <stdexcept>
#include <vector>

#include "phantoms/import/polygon.h"

namespace phantoms = wobblebench::phantoms;

namespace {

using Outline = std::vector<glm::dvec3>;

/// How often the outline runs about the point, which lies on none of its lines.
int windings(const Outline& outline, double x, double y) {
  int count = 0;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const auto &a = outline[i], &b = outline[(i + 1) % outline.size()];
    if ((a.y > y) == (b.y > y)) continue;
    const double side = (b.x - a.x) * (y - a.y) - (x - a.x) * (b.y - a.y);
    if (b.y > a.y && side > 0) ++count;
    if (b.y < a.y && side < 0) --count;
  }
  return count;
}

void check(const Outline& outline, const std::vector<phantoms::TriangleMesh::Triangle>& triangles) {
  int sign = 0;
  for (int x = 0; x < 16; ++x) {
    for (int y = 0; y < 16; ++y) {
      const double at_x = x + 0.4142, at_y = y + 0.7321;
      const int wound = windings(outline, at_x, at_y);
      int over = 0;
      for (const auto& t : triangles) {
        over += windings({outline[t[0]], outline[t[1]], outline[t[2]]}, at_x, at_y);
      }
      if (over != wound || wound * wound > 1 || wound * sign < 0) std::abort();
      if (wound != 0) sign = wound;
    }
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 3 || size > 60) return 0;
  Outline outline;
  for (const std::uint8_t byte : std::span(data, size))
    outline.emplace_back(byte % 16, byte / 16, 0);
  try {
    check(outline, phantoms::cut_polygon(outline));
  } catch (const std::invalid_argument&) {
  }
  return 0;
}
