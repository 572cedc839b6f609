// The march along a ray through a phantom that moves while it is scanned.
#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <utility>

#include "bench/evaluation/scanned_surfaces.h"

namespace wobblebench::bench {
namespace {

/// What the march takes where no leap is sure: far below a voxel.
constexpr double kLeastLeap_m = 0.1e-3;
constexpr double kBisected_m = 1e-6;
constexpr int kSweepSamples = 4;

}  // namespace

void ScannedSurfaces::look(const hw::Ray& ray, double at_m, Spot& spot) const {
  const glm::dvec3 position = ray.at(at_m);
  spot.at_m = at_m;
  spot.stick = stick_at(position);
  spot.rest_m = to_rest(position, spot.stick);
  spot.distance_m.clear();
  for (int target = 0; target < finder_.targets(); ++target) {
    spot.distance_m.push_back(finder_.distance_bound(target, spot.rest_m));
  }
}

/// How far at most the place at rest gets from the spot's own within a leap, at the spot's time.
double ScannedSurfaces::swept_m(const hw::Ray& ray, const Spot& spot, double length_m) const {
  if (motion_.rigid()) return length_m;
  double farthest = 0;
  for (int i = 1; i <= kSweepSamples; ++i) {
    const glm::dvec3 rest = to_rest(ray.at(spot.at_m + length_m * i / kSweepSamples), spot.stick);
    farthest = std::max(farthest, glm::distance(rest, spot.rest_m));
  }
  return farthest + bounds_.stretch * length_m / (2 * kSweepSamples);
}

/// How much later than the spot's, or earlier, a stick may be that shows a place within a leap.
/// Frames follow each other along a straight ray; lines may turn back, but not by more than the way
/// allows.
double ScannedSurfaces::lapse_s(const hw::Ray& ray, const Spot& spot, double length_m) const {
  const hw::StickIndex there = stick_at(ray.at(spot.at_m + length_m));
  const double lines = plan_.acquisition().sticks_per_frame;
  const double frames = std::abs(1.0 * there.frame - 1.0 * spot.stick.frame);
  const double step_m = geometry_.radius_m() * plan_.theta_step_rad();
  const double turned = lines > 1 ? std::min(lines, length_m / step_m + 1) : 0;
  return plan_.stick_period_s() * (frames * lines + turned);
}

/// How far nothing can be crossed: along the ray, and by what moves meanwhile.
double ScannedSurfaces::leap_m(const hw::Ray& ray, const Spot& spot) const {
  double clear_m = std::numeric_limits<double>::infinity();
  for (const double distance : spot.distance_m) clear_m = std::min(clear_m, std::abs(distance));
  double length_m = 0.9 * clear_m;
  while (length_m > kLeastLeap_m) {
    const double moved_m = bounds_.speed_m_s * lapse_s(ray, spot, length_m);
    if (moved_m < clear_m && swept_m(ray, spot, length_m) + moved_m <= clear_m) return length_m;
    length_m *= 0.6;
  }
  return kLeastLeap_m;
}

std::optional<SurfaceCrossing> ScannedSurfaces::first_of_moving(const hw::Ray& ray,
                                                                const render::Span& span,
                                                                render::EdgeSign sign) const {
  if (!(span.from_m < span.to_m) || finder_.targets() == 0) return std::nullopt;
  Spot before, behind;
  look(ray, span.from_m, before);
  while (before.at_m < span.to_m) {
    look(ray, std::min(span.to_m, before.at_m + leap_m(ray, before)), behind);
    std::optional<SurfaceCrossing> nearest;
    for (int target = 0; target < finder_.targets(); ++target) {
      const auto found = crossing(ray, target, before, behind, sign);
      if (found && (!nearest || found->distance_m < nearest->distance_m)) nearest = found;
    }
    if (nearest) return nearest;
    std::swap(before, behind);
  }
  return std::nullopt;
}

std::optional<SurfaceCrossing> ScannedSurfaces::crossing(
    const hw::Ray& ray, int target, Spot before, Spot behind, render::EdgeSign sign) const {
  const auto t = static_cast<std::size_t>(target);
  const auto inside = [t](const Spot& spot) { return spot.distance_m[t] < 0; };
  if (inside(before) == inside(behind)) return std::nullopt;
  while (behind.at_m - before.at_m > kBisected_m) {
    Spot middle;
    look(ray, 0.5 * (before.at_m + behind.at_m), middle);
    (inside(middle) == inside(before) ? before : behind) = std::move(middle);
  }
  const bool outside_is_fluid = outward(finder_.surface(target), {1, 0, 0}).x > 0;
  const bool enters_tissue = inside(behind) == outside_is_fluid;
  if (enters_tissue != (sign == render::EdgeSign::rising)) return std::nullopt;
  const auto there = finder_.target_distance(target, behind.rest_m);
  // A grid may be cut where nobody looks: there signs change without a surface. Where the stick
  // changes, tissue may have moved by more than its band.
  if (!there && before.stick == behind.stick) return std::nullopt;
  glm::dvec3 normal = inside(behind) ? -ray.direction : ray.direction;
  if (there) {
    normal = glm::normalize(gradient_now(ray.at(behind.at_m), behind.stick, there->gradient));
  }
  return SurfaceCrossing{behind.at_m, outward(finder_.surface(target), normal)};
}

}  // namespace wobblebench::bench
