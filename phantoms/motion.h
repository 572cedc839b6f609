// Motion of a phantom: maps between positions of tissue at a time and its positions at rest, in the
// phantom frame. The grids do not change: a position at a time is mapped to rest and sampled there.
#pragma once

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <optional>

#include "base/options.h"
#include "base/units.h"

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
  /// `rise_m`: at most 0.85 of the opening. The gap then keeps at least 0.15 of its height at
  /// each point, and the map its inverse.
  JawRise(const Mouth& mouth, double rise_m) : mouth_(mouth), rise_m_(rise_m) {}

  bool none() const { return rise_m_ == 0; }
  glm::dvec3 from_rest(const glm::dvec3& rest_m) const;
  /// The inverse, by safeguarded Newton iteration: within 1e-12 m.
  glm::dvec3 to_rest(const glm::dvec3& now_m) const;
  /// Jacobian of from_rest(), column by axis.
  glm::dmat3 jacobian(const glm::dvec3& rest_m) const;
  /// Distance from the box outside which nothing moves; 0 within it; infinite for none().
  double clearance_m(const glm::dvec3& rest_m) const;
  /// Upper bound of the distance at rest of two points over their distance now.
  double most_stretch() const;

 private:
  /// The position in the mouth's axes, from its centre.
  glm::dvec3 local(const glm::dvec3& position_m) const;
  bool within_box(const glm::dvec3& local_m) const;

  Mouth mouth_;
  double rise_m_ = 0;
};

/// A part of a phantom that can turn by itself: within `inner_m` of the centre tissue turns
/// rigidly, beyond `outer_m` not at all; in between each spherical shell turns by an angle that
/// falls from full to 0 with the radius (twice continuously differentiable). Since each shell is
/// mapped onto itself, volume is preserved and the inverse is exact.
struct Joint {
  glm::dvec3 center_m{0};
  double inner_m = 0;
  double outer_m = 0;
  std::optional<Mouth> mouth;  ///< the mouth of a head, which moves before the head turns
};

enum class HeadAxis {
  nod,    ///< about x
  shake,  ///< about y
  tilt,   ///< about z
};

/// The components of the motion as functions of time t. Components of amplitude zero are absent.
///   mouth      the jaw rises by close sin^2(pi t / period), as JawRise says
///   head       angle = head_turn sin(2 pi t / period) about the joint, right-handed
///   breath     y += amplitude sin(2 pi t / period)
///   heartbeat  z += amplitude sin^2(pi s / 0.3) while s < 0.3, s = the fraction of the period: a
///              beat of 0.3 periods, then rest; smooth (C1), 0 at t = 0
///   turning    p = R p, R turns by turn_rate t about the phantom's origin, about x, then y, then z
///   path       p += velocity t
/// A position at rest is mapped by them in this order: mouth, head, breath and heartbeat, turning,
/// path.
struct MotionOptions {
  glm::dvec3 velocity_m_s{0, 0, 0};     ///< velocity of the whole phantom, from time 0
  glm::dvec3 turn_rate_rad_s{0, 0, 0};  ///< about the phantom's origin, x then y then z
  double breath_amplitude_m = 0;        ///< peak displacement along y, a sine
  double breath_period_s = 4;
  double heartbeat_amplitude_m = 0;  ///< peak displacement along z, one short beat per period
  double heartbeat_period_s = 0.43;  ///< 140 beats per minute, as of a fetus
  double head_turn_rad = 0;  ///< peak angle of the head, a sine; needs a phantom with a joint
  double head_turn_period_s = 2;
  HeadAxis head_axis = HeadAxis::shake;
  double mouth_close_m = 0;  ///< peak rise of the jaw; needs a phantom whose mouth is open
  double mouth_period_s = 2;
};

template <OptionsOf<MotionOptions> O, class Visitor>
void describe(O& o, Visitor& v) {
  v.vec3("velocity_mm_s", o.velocity_m_s, kMillimetre, -500, 500);
  v.vec3("turn_rate_deg_s", o.turn_rate_rad_s, kDegree, -360, 360);
  v.real("breath_amplitude_mm", o.breath_amplitude_m, kMillimetre, 0, 50);
  v.real("breath_period_s", o.breath_period_s, 1, 0.1, 60);
  v.real("heartbeat_amplitude_mm", o.heartbeat_amplitude_m, kMillimetre, 0, 10);
  v.real("heartbeat_period_s", o.heartbeat_period_s, 1, 0.1, 10);
  v.real("head_turn_deg", o.head_turn_rad, kDegree, 0, 40);
  v.real("head_turn_period_s", o.head_turn_period_s, 1, 0.1, 60);
  v.choice("head_axis",
           o.head_axis,
           {{"nod", HeadAxis::nod}, {"shake", HeadAxis::shake}, {"tilt", HeadAxis::tilt}});
  v.real("mouth_close_mm", o.mouth_close_m, kMillimetre, 0, 8.5);
  v.real("mouth_period_s", o.mouth_period_s, 1, 0.1, 60);
}

/// Throws InvalidPhantom "KEY = VALUE: what is allowed".
void validate(const MotionOptions& options);

/// The deformation of a phantom at one time: maps positions at rest to current positions, and back.
/// Obtained once per time from Motion::at(), then applied to many positions. Metres, phantom frame.
///
/// @code
/// #include <iostream>
/// const phantoms::Motion motion(phantoms::MotionOptions{.velocity_m_s = {0.01, 0, 0}}, {});
/// const phantoms::Deformation deformation = motion.at(0.5);
/// const glm::dvec3 now_m = deformation.from_rest({0, 0, 0.02});  // (0.005, 0, 0.02)
/// const glm::dvec3 rest_m = deformation.to_rest(now_m);          // (0, 0, 0.02)
/// std::cout << now_m.x << " " << rest_m.x;
/// @endcode
class Deformation {
 public:
  glm::dvec3 to_rest(const glm::dvec3& now_m) const;
  glm::dvec3 from_rest(const glm::dvec3& rest_m) const;

  /// How much of the head's turn a body takes part in.
  enum class Turn {
    none,     ///< it does not turn with the head
    full,     ///< it turns rigidly with the head
    partial,  ///< it deforms, or reaches across a limit of the joint or of the jaw's movement
  };
  /// Turn of a ball about a position at rest.
  Turn turn_within(const glm::dvec3& rest_m, double radius_m) const;
  /// Radius of a ball about a position at rest that moves rigidly; 0 where tissue deforms.
  double rigid_radius_m(const glm::dvec3& rest_m) const;

  /// from_rest() and its Jacobian, column by axis.
  struct Tangent {
    glm::dvec3 position_m{0};
    glm::dmat3 jacobian{1.0};
  };
  Tangent tangent(const glm::dvec3& rest_m) const;
  /// The rigid transform of tissue that turns with the head fully or not at all, as the tangent at
  /// the phantom's origin. Not for Turn::partial.
  Tangent tangent_of(Turn turn) const;

 private:
  friend class Motion;
  Deformation() = default;
  /// `direction`: 1, or -1 for the inverse.
  glm::dvec3 head_turned(const glm::dvec3& position_m, double direction) const;
  Tangent head_tangent(const glm::dvec3& position_m) const;
  Tangent moved(const Tangent& turned) const;

  JawRise jaw_;
  Joint joint_;
  int head_axis_ = 0;
  double head_angle_rad_ = 0;
  double head_cosine_ = 1, head_sine_ = 0;
  bool turns_ = false;
  glm::dvec3 pulse_m_{0};  // breath and heartbeat
  glm::dmat3 turn_{1.0};
  glm::dvec3 path_m_{0};
};

/// Position of tissue as a function of device time in seconds. At time 0 everything is at rest.
/// Const functions may be called from any thread.
///
/// @code
/// #include <iostream>
/// phantoms::MotionOptions options;
/// options.breath_amplitude_m = 5e-3;
/// const phantoms::Motion motion(options, std::nullopt);
/// const glm::dvec3 now_m = motion.from_rest({0, 0, 0.02}, 1.0);  // (0, 0.005, 0.02)
/// std::cout << now_m.y << (motion.rigid() ? " rigid" : " head turns");
/// @endcode
class Motion {
 public:
  /// Nothing moves.
  Motion() = default;
  /// Throws as validate() does, if the options have a head turn but there is no joint, and if they
  /// close a mouth that is not there or not open so far.
  Motion(const MotionOptions& options, const std::optional<Joint>& joint);

  /// Nothing moves at any time.
  bool still() const;
  /// Neither head nor mouth moves: straight lines remain straight.
  bool rigid() const;

  /// What the mouth adds to the rest of the motion, at most, at any time.
  struct MouthBounds {
    double shift_m = 0;    ///< displacement of a position at rest
    double speed_m_s = 0;  ///< speed of the position at rest of a point that is fixed in the head
    double stretch = 1;    ///< distance at rest of two points over their distance now
  };
  MouthBounds mouth_bounds() const;
  /// The same with the mouth as at rest.
  Motion without_mouth() const;

  Deformation at(double time_s) const;
  /// Exact inverses of each other.
  glm::dvec3 to_rest(const glm::dvec3& now_m, double time_s) const {
    return at(time_s).to_rest(now_m);
  }
  glm::dvec3 from_rest(const glm::dvec3& rest_m, double time_s) const {
    return at(time_s).from_rest(rest_m);
  }

 private:
  bool head_turns() const { return options_.head_turn_rad != 0; }
  void check_mouth() const;
  bool mouth_moves() const { return options_.mouth_close_m != 0; }

  MotionOptions options_;
  std::optional<Joint> joint_;
};

}  // namespace wobblebench::phantoms
