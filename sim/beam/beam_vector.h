// Places as a stick's wide loops see them: floats in beam coordinates. A float's last digit is 1e-8
// m there, 1e-4 of a cycle.
#pragma once

#include <bit>
#include <cstdint>

#include "sim/math/simd.h"

namespace wobblebench::sim {

/// Metres along the stick, to the side in the image plane, and across it.
struct BeamVector {
  float axial = 0;
  float lateral = 0;
  float elevation = 0;
};

/// The library's way may be a call, which keeps loops narrow.
WOBBLEBENCH_INLINE float magnitude(float x) {
  return std::bit_cast<float>(std::bit_cast<std::uint32_t>(x) & 0x7fffffffu);
}

/// Where the beam ends: at an ellipse through its reach in both directions, or, for side lobes,
/// where the sum of both shares of the reach is 1.
enum class BeamRim { ellipse, diamond };

/// `u` and `v`, none negative, in the same measure as the reach.
template <BeamRim rim>
WOBBLEBENCH_INLINE bool within_rim(float u, float v, float reach) {
  return rim == BeamRim::ellipse ? u * u + v * v < reach * reach : u + v < reach;
}

}  // namespace wobblebench::sim
