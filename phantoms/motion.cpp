#include "phantoms/motion.h"
#include "base/units.h"
#include "phantoms/invalid_phantom.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <limits>

#include "phantoms/phantom.h"

namespace wobblebench::phantoms {
namespace {

constexpr double kBeatShare = 0.3;  // of the heartbeat's period; the rest of it is still

double sine(double time_s, double period_s) {
  return std::sin(2 * kPi * time_s / period_s);
}

double beat(double time_s, double period_s) {
  const double cycles = time_s / period_s;
  const double share = cycles - std::floor(cycles);
  if (share >= kBeatShare) return 0;
  const double root = std::sin(kPi * share / kBeatShare);
  return root * root;
}

// 1 at the joint's rigid part, 0 beyond its reach; 6 u^5 - 15 u^4 + 10 u^3 between them.
double share_of_turn(const Joint& joint, double from_center_m) {
  const double u = (joint.outer_m - from_center_m) / (joint.outer_m - joint.inner_m);
  if (u <= 0) return 0;
  if (u >= 1) return 1;
  return u * u * u * (u * (6 * u - 15) + 10);
}

// Its derivative: 30 u^2 (1 - u)^2 over the shell's thickness, falling outwards.
double slope_of_turn_per_m(const Joint& joint, double from_center_m) {
  const double thick_m = joint.outer_m - joint.inner_m;
  const double u = (joint.outer_m - from_center_m) / thick_m;
  if (u <= 0 || u >= 1) return 0;
  return -30 * u * u * (1 - u) * (1 - u) / thick_m;
}

// Right-handed about an axis of the frame.
glm::dvec3 turned(const glm::dvec3& v, int axis, double angle_rad) {
  const double c = std::cos(angle_rad), s = std::sin(angle_rad);
  const int next = (axis + 1) % 3, last = (axis + 2) % 3;
  glm::dvec3 result = v;
  result[next] = c * v[next] - s * v[last];
  result[last] = s * v[next] + c * v[last];
  return result;
}

glm::dmat3 turn_about(int axis, double angle_rad) {
  glm::dmat3 turn(1.0);
  for (int i = 0; i < 3; ++i) turn[i] = turned(turn[i], axis, angle_rad);
  return turn;
}

}  // namespace

void validate(const MotionOptions& options) {
  check_ranges(options);
}

glm::dvec3 Moment::head_turned(const glm::dvec3& place_m, double angle_rad) const {
  if (angle_rad == 0) return place_m;
  const glm::dvec3 arm = place_m - joint_.center_m;
  // A turn keeps the distance from the centre, so that both ways find the same share.
  const double share = share_of_turn(joint_, glm::length(arm));
  if (share == 0) return place_m;
  return joint_.center_m + turned(arm, head_axis_, share * angle_rad);
}

glm::dvec3 Moment::from_rest(const glm::dvec3& rest_m) const {
  const glm::dvec3 pulsed = head_turned(rest_m, head_angle_rad_) + pulse_m_;
  return (turns_ ? turn_ * pulsed : pulsed) + path_m_;
}

glm::dvec3 Moment::to_rest(const glm::dvec3& now_m) const {
  const glm::dvec3 on_path = now_m - path_m_;
  const glm::dvec3 pulsed = turns_ ? glm::transpose(turn_) * on_path : on_path;
  return head_turned(pulsed - pulse_m_, -head_angle_rad_);
}

double Moment::as_one_m(const glm::dvec3& rest_m) const {
  if (head_angle_rad_ == 0) return std::numeric_limits<double>::infinity();
  const double from_center_m = glm::length(rest_m - joint_.center_m);
  return std::max({0.0, from_center_m - joint_.outer_m, joint_.inner_m - from_center_m});
}

Moment::Turn Moment::turn_within(const glm::dvec3& rest_m, double radius_m) const {
  if (head_angle_rad_ == 0) return Turn::rests;
  if (as_one_m(rest_m) < radius_m) return Turn::bends;
  return glm::length(rest_m - joint_.center_m) < joint_.outer_m ? Turn::whole : Turn::rests;
}

Moment::Tangent Moment::moved(const Tangent& turned) const {
  const glm::dvec3 pulsed = turned.place_m + pulse_m_;
  if (!turns_) return {pulsed + path_m_, turned.turn};
  return {turn_ * pulsed + path_m_, turn_ * turned.turn};
}

Moment::Tangent Moment::tangent(const glm::dvec3& rest_m) const {
  if (head_angle_rad_ == 0) return moved({rest_m, glm::dmat3(1.0)});
  const glm::dvec3 arm = rest_m - joint_.center_m;
  const double from_center_m = glm::length(arm);
  const double angle_rad = share_of_turn(joint_, from_center_m) * head_angle_rad_;
  glm::dmat3 turn = turn_about(head_axis_, angle_rad);
  const glm::dvec3 now = turn * arm;
  const double slope = slope_of_turn_per_m(joint_, from_center_m);
  if (slope != 0) {
    // What lies farther out turns less: it moves across the axis as well.
    glm::dvec3 axis(0);
    axis[head_axis_] = 1;
    const glm::dvec3 across = glm::cross(axis, now) * (head_angle_rad_ * slope);
    turn += glm::outerProduct(across, arm / from_center_m);
  }
  return moved({joint_.center_m + now, turn});
}

Moment::Tangent Moment::tangent_of(Turn turn) const {
  if (turn == Turn::rests || head_angle_rad_ == 0) return moved({glm::dvec3(0), glm::dmat3(1.0)});
  const glm::dmat3 whole = turn_about(head_axis_, head_angle_rad_);
  return moved({joint_.center_m - whole * joint_.center_m, whole});
}

Motion::Motion(const MotionOptions& options, const std::optional<Joint>& joint)
    : options_(options), joint_(joint) {
  validate(options);
  if (options.head_turn_rad != 0 && !joint) {
    throw refusal("head_turn_deg",
                  options.head_turn_rad * 180 / kPi,
                  "this phantom has no head that turns; it must be 0");
  }
}

bool Motion::rigid() const {
  return options_.head_turn_rad == 0;
}

bool Motion::still() const {
  return rigid() && options_.velocity_m_s == glm::dvec3(0) &&
         options_.turn_rate_rad_s == glm::dvec3(0) && options_.breath_amplitude_m == 0 &&
         options_.heartbeat_amplitude_m == 0;
}

Moment Motion::at(double time_s) const {
  const MotionOptions& o = options_;
  Moment moment;
  if (!rigid()) {
    moment.joint_ = *joint_;
    moment.head_axis_ = static_cast<int>(o.head_axis);
    moment.head_angle_rad_ = o.head_turn_rad * sine(time_s, o.head_turn_period_s);
  }
  if (o.breath_amplitude_m != 0) {
    moment.pulse_m_.y = o.breath_amplitude_m * sine(time_s, o.breath_period_s);
  }
  if (o.heartbeat_amplitude_m != 0) {
    moment.pulse_m_.z = o.heartbeat_amplitude_m * beat(time_s, o.heartbeat_period_s);
  }
  moment.turns_ = o.turn_rate_rad_s != glm::dvec3(0);
  if (moment.turns_) moment.turn_ = rotation_xyz(time_s * o.turn_rate_rad_s);
  moment.path_m_ = time_s * o.velocity_m_s;
  return moment;
}

}  // namespace wobblebench::phantoms
