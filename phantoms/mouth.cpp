#include "phantoms/mouth.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <limits>

namespace wobblebench::phantoms {
namespace {

// Shares of `reach_m`: to here in full, from here on not at all.
constexpr double kFrontFull = 0.4, kFront = 1, kBack = 1.6, kChinFull = 1.25, kNeck = 2.5;
// Of the opening: length over which the slope of g rises, and falls, about the edge of either lip.
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
  constexpr int kMostSteps = 60;
  // v - rise g(v) - y rises with v: its root lies where it changes sign.
  double low = p.y, high = p.y + rise, v = p.y;
  for (int step = 0; step < kMostSteps; ++step) {
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

}  // namespace wobblebench::phantoms
