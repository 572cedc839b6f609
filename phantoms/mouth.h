// A mouth that is open at rest, and the map of tissue that closes it.
#pragma once

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

namespace wobblebench::phantoms {

/// A mouth, open at rest, and the lower jaw that closes it. The jaw moves within a box about the
/// mouth and in full at its middle: to the sides the displacement falls to 0 at `reach_m` from the
/// median plane, behind the lips at 1.6 and in front of them at 1 `reach_m`, down the neck at 2.5.
struct Mouth {
  /// Columns: unit vectors to an observer's right, to the chin, and to the occiput; phantom frame.
  glm::dmat3 axes{1.0};
  glm::dvec3 center_m{0};  ///< middle of the gap between the lips, in the median plane
  double opening_m = 0;    ///< height of the gap, at rest
  double reach_m = 0;      ///< at least 3 / 4 of the opening
};

/// Whether its sizes are positive, and its axes orthonormal within 1e-9.
bool is_possible(const Mouth& mouth);

/// Largest share of the opening by which the jaw may rise: the gap then keeps at least 0.15 of its
/// height at each point, and the map its inverse.
inline constexpr double kMostClosed = 0.85;

/// The lower jaw raised by a height: y = v - rise w(x, z) g(v) along the axis to the chin, x, y, z
/// and v in the mouth's axes. w = 1 at the lips. g rises from 0 in the upper lip to 1 in the lower
/// one, linearly within the gap, and falls from 1 to 0 down the neck. All are twice continuously
/// differentiable. Fluid and tissue between the lips are compressed, the neck is stretched.
///
/// @code
/// #include <cstdio>
/// const phantoms::Mouth mouth{.opening_m = 6e-3, .reach_m = 16e-3};
/// const phantoms::JawRise jaw(mouth, 3e-3);
/// const glm::dvec3 lip_m = jaw.from_rest({0, 3e-3, 0});  // the lower lip, raised by up to 3 mm
/// std::printf("%g mm\n", lip_m.y / kMillimetre);
/// @endcode
class JawRise {
 public:
  JawRise() = default;  ///< nothing moves
  /// `rise_m`: at most kMostClosed of the opening.
  JawRise(const Mouth& mouth, double rise_m) : mouth_(mouth), rise_m_(rise_m) {}

  bool none() const { return rise_m_ == 0; }
  glm::dvec3 from_rest(const glm::dvec3& rest_m) const;
  /// The inverse, by safeguarded Newton iteration: within 1e-12 m.
  glm::dvec3 to_rest(const glm::dvec3& now_m) const;
  /// Of from_rest(), column by axis.
  glm::dmat3 jacobian(const glm::dvec3& rest_m) const;
  /// Distance from the box outside which nothing moves; 0 within it; infinite for none().
  double clearance_m(const glm::dvec3& rest_m) const;
  /// Upper bound of the distance at rest of two points over their distance now.
  double most_stretch() const;

 private:
  /// In the mouth's axes, from its centre.
  glm::dvec3 local(const glm::dvec3& position_m) const;
  bool within_box(const glm::dvec3& local_m) const;

  Mouth mouth_;
  double rise_m_ = 0;
};

}  // namespace wobblebench::phantoms
