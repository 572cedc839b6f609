// The draw of an identity: which child the phantom shows.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>

#include "phantoms/fetal/face_measures.h"

namespace wobblebench::phantoms {

/// Traits for which no spread was found in the literature: all are assumed. A ratio is to the mean
/// child's, a length in millimetres of the face of 21 weeks.
struct FaceTraits {
  double mouth_width = 1;   ///< ratio
  double lip_fullness = 1;  ///< ratio
  double nose_width = 1;    ///< ratio
  double nostril_tilt = 0;  ///< length by which the tip of the nose is higher
  double ear_breadth = 1;   ///< ratio
  double ear_stands_off = 0;
  double brow = 0;         ///< length by which the brow is more prominent
  double cheek_full = 0;   ///< length by which the cheeks are more prominent
  double chin_width = 1;   ///< ratio
  double chin_point = 0;   ///< length by which the tip of the chin is smaller
  double eye_slant = 0;    ///< length by which the outer corners of the lids are higher
  double eye_depth = 0;    ///< length by which the eyes lie deeper
  double nose_bridge = 0;  ///< length by which the middle of the ridge is more prominent
  double crown = 1;        ///< ratio of the height of the braincase
};

/// Parts of which the right differs from the left, and the middle of the nose.
enum class PairedPart : std::size_t { eye, brow, cheek, ala, mouth, ear, jaw, zygoma, nose_tip };
inline constexpr std::size_t kPairedParts = 9;

/// Difference of right and left, metres: each is shifted by half of it, away from the mirror image
/// of the other. Of the nose: its tip's shift to the right, x alone.
using Asymmetry = std::array<glm::dvec3, kPairedParts>;

struct FaceIdentity {
  double weeks = 21;
  FaceMeasures measures;  ///< what the finished surface is to measure
  FaceTraits traits = {};
  Asymmetry asymmetry = {};
};

/// The child of this seed at this age. 0: the mean child, symmetric. Every other seed draws each
/// measure and trait by a random number of its own, a function of seed and name, so that a new one
/// changes no old identity. Sizes share one factor, the Z-score of the head circumference
/// (size_correlation()), and the facial height shares the deviations of its parts; all Z-scores are
/// within 3. One seed at two ages is one child: its Z-scores
/// differ only by the correlation's change.
FaceIdentity draw_identity(std::uint64_t seed, double weeks);

}  // namespace wobblebench::phantoms
