// Beam coordinates in single precision, for vectorised loops, and the shape of the beam's rim. The
// resolution of a float is 1e-8 m there, 1e-4 of a cycle.
#pragma once

#include <bit>
#include <cstdint>

#include "sim/math/simd.h"

namespace wobblebench::sim {

/// Metres along the stick, across it in the image plane, and across the image plane.
struct BeamVector {
  float axial = 0;
  float lateral = 0;
  float elevation = 0;
};

/// std::abs may be a call, which prevents vectorisation.
WOBBLEBENCH_INLINE float magnitude(float x) {
  return std::bit_cast<float>(std::bit_cast<std::uint32_t>(x) & 0x7fffffffu);
}

/// Shape of the beam's edge across the axis: an ellipse through its reach in both directions, or,
/// for side lobes, a diamond, where the two offsets over their reach add up to 1.
enum class BeamRim { ellipse, diamond };

/// `u` and `v`: magnitudes of the offsets in both directions, scaled to a common `reach`.
template <BeamRim rim>
WOBBLEBENCH_INLINE bool within_rim(float u, float v, float reach) {
  return rim == BeamRim::ellipse ? u * u + v * v < reach * reach : u + v < reach;
}

}  // namespace wobblebench::sim
