// How a phantom moves: a map between where tissue is now and where it lies at rest, in the phantom
// frame. Grids stay as they are; who asks about a place at a time asks about its place at rest.
#pragma once

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <optional>

#include "base/options.h"
#include "base/units.h"

namespace wobblebench::phantoms {

/// A part of a phantom that can turn by itself: within `inner_m` of the centre tissue turns as one,
/// beyond `outer_m` it rests, between them each spherical shell turns by its share (twice
/// continuously differentiable). Every shell slides in itself, so that volume is kept and the
/// inverse is exact.
struct Joint {
  glm::dvec3 center_m{0};
  double inner_m = 0;
  double outer_m = 0;
};

enum class HeadAxis {
  nod,    ///< about x
  shake,  ///< about y
  tilt,   ///< about z
};

/// How the parts of the motion change with time t. Parts that are zero do not move.
///   head       angle = head_turn sin(2 pi t / period) about the joint, right-handed
///   breath     y += amplitude sin(2 pi t / period)
///   heartbeat  z += amplitude sin^2(pi s / 0.3) while s < 0.3, s = the fraction of the period: a
///              beat of 0.3 periods, then rest; smooth (C1), 0 at t = 0
///   turning    p = R p, R turns by turn_rate t about the phantom's origin, about x, then y, then z
///   path       p += velocity t
/// A place at rest goes through them in this order: head, breath and heartbeat, turning, path.
struct MotionOptions {
  glm::dvec3 velocity_m_s{0, 0, 0};     ///< of the whole phantom from time 0
  glm::dvec3 turn_rate_rad_s{0, 0, 0};  ///< about the phantom's origin, x then y then z
  double breath_amplitude_m = 0;        ///< peak displacement along y, a sine
  double breath_period_s = 4;
  double heartbeat_amplitude_m = 0;  ///< peak displacement along z, a short beat each period
  double heartbeat_period_s = 0.43;  ///< 140 a minute, a fetus
  double head_turn_rad = 0;          ///< peak angle of the head, a sine; phantoms with a joint only
  double head_turn_period_s = 2;
  HeadAxis head_axis = HeadAxis::shake;
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
}

/// Throws InvalidPhantom "KEY = VALUE: what is allowed".
void validate(const MotionOptions& options);

/// All of a motion at one time; who asks for many places at a time asks this.
class Moment {
 public:
  glm::dvec3 to_rest(const glm::dvec3& now_m) const;
  glm::dvec3 from_rest(const glm::dvec3& rest_m) const;

  /// How a body moves about a place at rest.
  enum class Turn {
    rests,  ///< without the head
    whole,  ///< with the head, as one
    bends,  ///< between both
  };
  /// Of all within a distance of a place at rest.
  Turn turn_within(const glm::dvec3& rest_m, double radius_m) const;
  /// All this close to a place at rest moves as one; 0 where tissue bends.
  double as_one_m(const glm::dvec3& rest_m) const;

  /// from_rest() and its derivative, column by axis.
  struct Tangent {
    glm::dvec3 place_m{0};
    glm::dmat3 turn{1.0};
  };
  Tangent tangent(const glm::dvec3& rest_m) const;
  /// The tangent of what rests, or of what turns as a whole, at the phantom's origin.
  Tangent tangent_of(Turn turn) const;

 private:
  friend class Motion;
  Moment() = default;
  glm::dvec3 head_turned(const glm::dvec3& place_m, double angle_rad) const;
  Tangent moved(const Tangent& turned) const;

  Joint joint_;
  int head_axis_ = 0;
  double head_angle_rad_ = 0;
  bool turns_ = false;
  glm::dvec3 pulse_m_{0};  // breath and heartbeat
  glm::dmat3 turn_{1.0};
  glm::dvec3 path_m_{0};
};

/// Where tissue is at a time in seconds of device time. At time 0 everything is at rest. Const
/// functions may be called from any thread.
class Motion {
 public:
  /// Nothing moves.
  Motion() = default;
  /// Throws as validate() does, and where a head turn is asked for without a joint.
  Motion(const MotionOptions& options, const std::optional<Joint>& joint);

  bool still() const;
  /// Lines stay lines: no head turn.
  bool rigid() const;

  Moment at(double time_s) const;
  /// Each the exact inverse of the other.
  glm::dvec3 to_rest(const glm::dvec3& now_m, double time_s) const {
    return at(time_s).to_rest(now_m);
  }
  glm::dvec3 from_rest(const glm::dvec3& rest_m, double time_s) const {
    return at(time_s).from_rest(rest_m);
  }

 private:
  MotionOptions options_;
  std::optional<Joint> joint_;
};

}  // namespace wobblebench::phantoms
