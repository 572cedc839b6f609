#include "phantoms/motion.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <limits>
#include <sstream>

#include "base/units.h"
#include "phantoms/phantom.h"
#include "phantoms/refusal.h"

namespace wobblebench::phantoms {
namespace {

// Shares of `reach_m`: to here in full, from here on not at all.
constexpr double kFrontFull = 0.4, kFront = 1, kBack = 1.6, kChinFull = 1.25, kNeck = 2.5;
// Length over which the slope of g rises, and falls, about the edge of either lip, per opening.
constexpr double kRamp = 0.5;
constexpr double kSteepestFade = 1.875;  // of fade(), for each unit of its argument

struct Value {
  double value;
  double slope;
};

// 1 for u <= 0, 0 for u >= 1; 1 - 10 u^3 + 15 u^4 - 6 u^5 in between.
Value fade(double u) {
  if (u <= 0) return {1, 0};
  if (u >= 1) return {0, 0};
  return {1 - u * u * u * (10 - u * (15 - 6 * u)), -30 * u * u * (1 - u) * (1 - u)};
}

// fade() from 1 at `full` to 0 at `none`, with its slope for each unit of x.
Value fade(double x, double full, double none) {
  const Value f = fade((x - full) / (none - full));
  return {f.value, f.slope / (none - full)};
}

// max(s, 0), rounded within 1/2 of 0: the integral of a smoothstep.
Value rounded_ramp(double s) {
  const double u = s + 0.5;
  if (u <= 0) return {0, 0};
  if (u >= 1) return {s, 1};
  return {u * u * u * (1 - 0.5 * u), u * u * (3 - 2 * u)};
}

// Share of the jaw's rise at a height below the middle of the mouth.
Value share_at(const Mouth& mouth, double v) {
  const double t = v / mouth.opening_m + 0.5;
  const Value begin = rounded_ramp(t / kRamp), end = rounded_ramp((t - 1) / kRamp);
  const Value rising{kRamp * (begin.value - end.value),
                     (begin.slope - end.slope) / mouth.opening_m};
  const double lip = 0.5 * mouth.opening_m;
  const Value falling = fade(v, lip + kChinFull * mouth.reach_m, lip + kNeck * mouth.reach_m);
  return {rising.value * falling.value,
          rising.slope * falling.value + rising.value * falling.slope};
}

Value share_across(const Mouth& mouth, double x) {
  const Value f = fade(std::abs(x), 0, mouth.reach_m);
  return {f.value, x < 0 ? -f.slope : f.slope};
}

Value share_behind(const Mouth& mouth, double z) {
  if (z >= 0) return fade(z, 0, kBack * mouth.reach_m);
  const Value front = fade(-z, kFrontFull * mouth.reach_m, kFront * mouth.reach_m);
  return {front.value, -front.slope};
}

glm::dvec3 box_low(const Mouth& mouth) {
  return {-mouth.reach_m, -0.5 * (1 + kRamp) * mouth.opening_m, -kFront * mouth.reach_m};
}

glm::dvec3 box_high(const Mouth& mouth) {
  return {mouth.reach_m, 0.5 * mouth.opening_m + kNeck * mouth.reach_m, kBack * mouth.reach_m};
}

}  // namespace

bool is_possible(const Mouth& mouth) {
  const glm::dmat3 squared = glm::transpose(mouth.axes) * mouth.axes;
  for (int axis = 0; axis < 3; ++axis) {
    glm::dvec3 unit(0);
    unit[axis] = 1;
    if (!(glm::distance(squared[axis], unit) < 1e-9)) return false;
  }
  return mouth.opening_m > 0 && mouth.reach_m >= 0.75 * mouth.opening_m;
}

glm::dvec3 JawRise::local(const glm::dvec3& position_m) const {
  return (position_m - mouth_.center_m) * mouth_.axes;
}

// At rest or now alike: the box is mapped onto itself.
bool JawRise::within_box(const glm::dvec3& local_m) const {
  return glm::all(glm::greaterThan(local_m, box_low(mouth_))) &&
         glm::all(glm::lessThan(local_m, box_high(mouth_)));
}

glm::dvec3 JawRise::from_rest(const glm::dvec3& rest_m) const {
  if (none()) return rest_m;
  const glm::dvec3 p = local(rest_m);
  if (!within_box(p)) return rest_m;
  const double share = share_across(mouth_, p.x).value * share_behind(mouth_, p.z).value *
                       share_at(mouth_, p.y).value;
  return rest_m - rise_m_ * share * mouth_.axes[1];
}

glm::dvec3 JawRise::to_rest(const glm::dvec3& now_m) const {
  if (none()) return now_m;
  const glm::dvec3 p = local(now_m);
  if (!within_box(p)) return now_m;
  const double rise = rise_m_ * share_across(mouth_, p.x).value * share_behind(mouth_, p.z).value;
  constexpr double kConverged_m = 1e-14;
  constexpr int kMostBisections = 60;
  // v - rise g(v) - y rises with v: its root lies where it changes sign.
  double low = p.y, high = p.y + rise, v = p.y;
  for (int step = 0; step < kMostBisections; ++step) {
    const Value g = share_at(mouth_, v);
    const double excess = v - rise * g.value - p.y;
    (excess > 0 ? high : low) = v;
    double next = v - excess / (1 - rise * g.slope);
    if (next < low || next > high) next = 0.5 * (low + high);
    const double moved = std::abs(next - v);
    v = next;
    if (moved < kConverged_m) break;
  }
  return now_m + (v - p.y) * mouth_.axes[1];
}

glm::dmat3 JawRise::jacobian(const glm::dvec3& rest_m) const {
  glm::dmat3 result(1.0);
  if (none()) return result;
  const glm::dvec3 p = local(rest_m);
  if (!within_box(p)) return result;
  const Value x = share_across(mouth_, p.x), y = share_at(mouth_, p.y),
              z = share_behind(mouth_, p.z);
  const glm::dvec3 slope{
      x.slope * y.value * z.value, x.value * y.slope * z.value, x.value * y.value * z.slope};
  return result - glm::outerProduct(rise_m_ * mouth_.axes[1], mouth_.axes * slope);
}

double JawRise::clearance_m(const glm::dvec3& rest_m) const {
  if (none()) return std::numeric_limits<double>::infinity();
  const glm::dvec3 p = local(rest_m);
  return glm::length(glm::max(glm::max(box_low(mouth_) - p, p - box_high(mouth_)), 0.0));
}

double JawRise::most_stretch() const {
  if (none()) return 1;
  // The inverse of 1 - e s^T is 1 + e s^T / (1 - s_y), s_y at most rise / opening.
  const double across = kSteepestFade / mouth_.reach_m;
  const glm::dvec3 slope{across,
                         std::max(1 / mouth_.opening_m, across / (kNeck - kChinFull)),
                         across / (kFront - kFrontFull)};
  return 1 + rise_m_ * glm::length(slope) / (1 - rise_m_ / mouth_.opening_m);
}

namespace {

// Largest rise of the jaw, per opening of the mouth.
constexpr double kMostClosed = 0.85;
// Largest rise of the jaw, per its reach: tissue is then stretched by at most 1.5 (measured), as
// the search for scatterers in the beam assumes of tissue that deforms
// (sim/speckle/scatterers/block_search.cpp).
constexpr double kMostRise = 1.0 / 3;
constexpr double kBeatShare = 0.3;  // of the heartbeat's period; no displacement in the rest of it

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

double raised(double time_s, double period_s) {
  const double root = std::sin(kPi * time_s / period_s);
  return root * root;
}

// 1 within inner_m, 0 beyond outer_m; 6 u^5 - 15 u^4 + 10 u^3 in between.
double turn_fraction(const Joint& joint, double from_center_m) {
  const double u = (joint.outer_m - from_center_m) / (joint.outer_m - joint.inner_m);
  if (u <= 0) return 0;
  if (u >= 1) return 1;
  return u * u * u * (u * (6 * u - 15) + 10);
}

// Its derivative: -30 u^2 (1 - u)^2 over the thickness of the shell.
double turn_fraction_slope_per_m(const Joint& joint, double from_center_m) {
  const double thick_m = joint.outer_m - joint.inner_m;
  const double u = (joint.outer_m - from_center_m) / thick_m;
  if (u <= 0 || u >= 1) return 0;
  return -30 * u * u * (1 - u) * (1 - u) / thick_m;
}

// Right-handed about an axis of the frame, by an angle of cosine c and sine s.
glm::dvec3 turned(const glm::dvec3& v, int axis, double c, double s) {
  const int next = (axis + 1) % 3, last = (axis + 2) % 3;
  glm::dvec3 result = v;
  result[next] = c * v[next] - s * v[last];
  result[last] = s * v[next] + c * v[last];
  return result;
}

glm::dmat3 turn_about(int axis, double angle_rad) {
  glm::dmat3 turn(1.0);
  const double c = std::cos(angle_rad), s = std::sin(angle_rad);
  for (int i = 0; i < 3; ++i) turn[i] = turned(turn[i], axis, c, s);
  return turn;
}

}  // namespace

void validate(const MotionOptions& options) {
  check_ranges(options);
}

glm::dvec3 Deformation::head_turned(const glm::dvec3& position_m, double direction) const {
  if (head_angle_rad_ == 0) return position_m;
  const glm::dvec3 arm = position_m - joint_.center_m;
  // A turn keeps the distance from the centre, so that the inverse finds the same fraction.
  const double fraction = turn_fraction(joint_, glm::length(arm));
  if (fraction == 0) return position_m;
  if (fraction == 1) {
    return joint_.center_m + turned(arm, head_axis_, head_cosine_, direction * head_sine_);
  }
  const double angle_rad = fraction * direction * head_angle_rad_;
  return joint_.center_m + turned(arm, head_axis_, std::cos(angle_rad), std::sin(angle_rad));
}

glm::dvec3 Deformation::from_rest(const glm::dvec3& rest_m) const {
  const glm::dvec3 pulsed = head_turned(jaw_.from_rest(rest_m), 1) + pulse_m_;
  return (turns_ ? turn_ * pulsed : pulsed) + path_m_;
}

glm::dvec3 Deformation::to_rest(const glm::dvec3& now_m) const {
  const glm::dvec3 on_path = now_m - path_m_;
  const glm::dvec3 pulsed = turns_ ? glm::transpose(turn_) * on_path : on_path;
  return jaw_.to_rest(head_turned(pulsed - pulse_m_, -1));
}

double Deformation::rigid_radius_m(const glm::dvec3& rest_m) const {
  const double from_jaw_m = jaw_.clearance_m(rest_m);
  if (head_angle_rad_ == 0) return from_jaw_m;
  const double from_center_m = glm::length(rest_m - joint_.center_m);
  return std::min(from_jaw_m,
                  std::max({0.0, from_center_m - joint_.outer_m, joint_.inner_m - from_center_m}));
}

Deformation::Turn Deformation::turn_within(const glm::dvec3& rest_m, double radius_m) const {
  if (rigid_radius_m(rest_m) < radius_m) return Turn::partial;
  if (head_angle_rad_ == 0) return Turn::none;
  return glm::length(rest_m - joint_.center_m) < joint_.outer_m ? Turn::full : Turn::none;
}

Deformation::Tangent Deformation::moved(const Tangent& turned) const {
  const glm::dvec3 pulsed = turned.position_m + pulse_m_;
  if (!turns_) return {pulsed + path_m_, turned.jacobian};
  return {turn_ * pulsed + path_m_, turn_ * turned.jacobian};
}

Deformation::Tangent Deformation::tangent(const glm::dvec3& rest_m) const {
  if (jaw_.none()) return moved(head_tangent(rest_m));
  Tangent head = head_tangent(jaw_.from_rest(rest_m));
  head.jacobian = head.jacobian * jaw_.jacobian(rest_m);
  return moved(head);
}

Deformation::Tangent Deformation::head_tangent(const glm::dvec3& position_m) const {
  if (head_angle_rad_ == 0) return {position_m, glm::dmat3(1.0)};
  const glm::dvec3 arm = position_m - joint_.center_m;
  const double from_center_m = glm::length(arm);
  const double angle_rad = turn_fraction(joint_, from_center_m) * head_angle_rad_;
  glm::dmat3 turn = turn_about(head_axis_, angle_rad);
  const glm::dvec3 now = turn * arm;
  const double slope = turn_fraction_slope_per_m(joint_, from_center_m);
  if (slope != 0) {
    // The turn angle falls with the radius: the derivative of the angle adds a shear.
    glm::dvec3 axis(0);
    axis[head_axis_] = 1;
    const glm::dvec3 across = glm::cross(axis, now) * (head_angle_rad_ * slope);
    turn += glm::outerProduct(across, arm / from_center_m);
  }
  return {joint_.center_m + now, turn};
}

Deformation::Tangent Deformation::tangent_of(Turn turn) const {
  if (turn == Turn::none || head_angle_rad_ == 0) return moved({glm::dvec3(0), glm::dmat3(1.0)});
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
  if (mouth_moves()) check_mouth();
}

void Motion::check_mouth() const {
  const double close_mm = options_.mouth_close_m / kMillimetre;
  if (!joint_ || !joint_->mouth) {
    throw refusal("mouth_close_mm", close_mm, "this phantom has no open mouth; it must be 0");
  }
  const Mouth& mouth = *joint_->mouth;
  const double most_mm =
      std::min(kMostClosed * mouth.opening_m, kMostRise * mouth.reach_m) / kMillimetre;
  if (close_mm <= most_mm * (1 + 1e-12)) return;
  std::ostringstream allowed;
  allowed << "must be at most " << most_mm << " for this mouth";
  throw refusal("mouth_close_mm", close_mm, allowed.str());
}

bool Motion::rigid() const {
  return !head_turns() && !mouth_moves();
}

bool Motion::still() const {
  return rigid() && options_.velocity_m_s == glm::dvec3(0) &&
         options_.turn_rate_rad_s == glm::dvec3(0) && options_.breath_amplitude_m == 0 &&
         options_.heartbeat_amplitude_m == 0;
}

Motion::MouthBounds Motion::mouth_bounds() const {
  if (!mouth_moves()) return {};
  const double close_m = options_.mouth_close_m;
  const double least_left = 1 - close_m / joint_->mouth->opening_m;  // of a height, anywhere
  const double fastest_m_s = kPi * close_m / options_.mouth_period_s;
  return {close_m, fastest_m_s / least_left, JawRise(*joint_->mouth, close_m).most_stretch()};
}

Motion Motion::without_mouth() const {
  Motion result = *this;
  result.options_.mouth_close_m = 0;
  return result;
}

Deformation Motion::at(double time_s) const {
  const MotionOptions& o = options_;
  Deformation result;
  if (mouth_moves()) {
    result.jaw_ = JawRise(*joint_->mouth, o.mouth_close_m * raised(time_s, o.mouth_period_s));
  }
  if (head_turns()) {
    result.joint_ = *joint_;
    result.head_axis_ = static_cast<int>(o.head_axis);
    result.head_angle_rad_ = o.head_turn_rad * sine(time_s, o.head_turn_period_s);
    result.head_cosine_ = std::cos(result.head_angle_rad_);
    result.head_sine_ = std::sin(result.head_angle_rad_);
  }
  if (o.breath_amplitude_m != 0) {
    result.pulse_m_.y = o.breath_amplitude_m * sine(time_s, o.breath_period_s);
  }
  if (o.heartbeat_amplitude_m != 0) {
    result.pulse_m_.z = o.heartbeat_amplitude_m * beat(time_s, o.heartbeat_period_s);
  }
  result.turns_ = o.turn_rate_rad_s != glm::dvec3(0);
  if (result.turns_) result.turn_ = rotation_xyz(time_s * o.turn_rate_rad_s);
  result.path_m_ = time_s * o.velocity_m_s;
  return result;
}

}  // namespace wobblebench::phantoms
