// Ray marching through a phantom that moves while it is scanned.
#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <utility>

#include "bench/evaluation/truth/scanned_surfaces.h"

namespace wobblebench::bench {
namespace {

/// Step where no longer one is safe: far below a voxel.
constexpr double kLeastStep_m = 0.1e-3;
constexpr double kBisected_m = 1e-6;
constexpr int kDisplacementSamples = 4;

}  // namespace

void ScannedSurfaces::sample(const hw::Ray& ray, double at_m, RaySample& sample) const {
  const glm::dvec3 position = ray.at(at_m);
  sample.at_m = at_m;
  sample.stick = stick_at(position);
  sample.rest_m = to_rest(position, sample.stick);
  sample.distance_m.clear();
  for (int target = 0; target < finder_.targets(); ++target) {
    sample.distance_m.push_back(finder_.distance_bound(target, sample.rest_m));
  }
}

/// Upper bound of the distance between the rest positions of `from` and of any point of the ray up
/// to `step_m` beyond it, all at the time of `from`.
double ScannedSurfaces::rest_displacement_m(const hw::Ray& ray,
                                            const RaySample& from,
                                            double step_m) const {
  if (subject_.motion.rigid()) return step_m;
  double farthest = 0;
  for (int i = 1; i <= kDisplacementSamples; ++i) {
    const glm::dvec3 rest =
        to_rest(ray.at(from.at_m + step_m * i / kDisplacementSamples), from.stick);
    farthest = std::max(farthest, glm::distance(rest, from.rest_m));
  }
  return farthest + bounds_.stretch * step_m / (2 * kDisplacementSamples);
}

/// Upper bound of the time between the stick of `from` and that of any point of the ray up to
/// `step_m` beyond it. Frame numbers are monotonic along a straight ray; line numbers may turn
/// back, but change by no more than the step's length allows.
double ScannedSurfaces::time_difference_s(const hw::Ray& ray,
                                          const RaySample& from,
                                          double step_m) const {
  const hw::StickIndex there = stick_at(ray.at(from.at_m + step_m));
  const double lines = plan_.acquisition().sticks_per_frame;
  const double frames = std::abs(1.0 * there.frame - 1.0 * from.stick.frame);
  const double line_step_m = geometry_.radius_m() * plan_.theta_step_rad();
  const double turned = lines > 1 ? std::min(lines, step_m / line_step_m + 1) : 0;
  return plan_.stick_period_s() * (frames * lines + turned);
}

/// A step along the ray within which no surface can be crossed, whatever moves meanwhile.
double ScannedSurfaces::safe_step_m(const hw::Ray& ray, const RaySample& from) const {
  double clear_m = std::numeric_limits<double>::infinity();
  for (const double distance : from.distance_m) clear_m = std::min(clear_m, std::abs(distance));
  double step_m = 0.9 * clear_m;
  while (step_m > kLeastStep_m) {
    const double moved_m = bounds_.speed_m_s * time_difference_s(ray, from, step_m);
    if (moved_m < clear_m && rest_displacement_m(ray, from, step_m) + moved_m <= clear_m)
      return step_m;
    step_m *= 0.6;
  }
  return kLeastStep_m;
}

std::optional<SurfaceCrossing> ScannedSurfaces::first_of_moving(const hw::Ray& ray,
                                                                const render::Span& span) const {
  if (!(span.from_m < span.to_m) || finder_.targets() == 0) return std::nullopt;
  RaySample before, behind;
  sample(ray, span.from_m, before);
  while (before.at_m < span.to_m) {
    sample(ray, std::min(span.to_m, before.at_m + safe_step_m(ray, before)), behind);
    std::optional<SurfaceCrossing> nearest;
    for (int target = 0; target < finder_.targets(); ++target) {
      const auto found = crossing(ray, target, before, behind);
      if (found && (!nearest || found->distance_m < nearest->distance_m)) nearest = found;
    }
    if (nearest) return nearest;
    std::swap(before, behind);
  }
  return std::nullopt;
}

std::optional<SurfaceCrossing> ScannedSurfaces::crossing(const hw::Ray& ray,
                                                         int target,
                                                         RaySample before,
                                                         RaySample behind) const {
  const auto t = static_cast<std::size_t>(target);
  const auto inside = [t](const RaySample& sample) { return sample.distance_m[t] < 0; };
  if (inside(before) == inside(behind)) return std::nullopt;
  while (behind.at_m - before.at_m > kBisected_m) {
    RaySample middle;
    sample(ray, 0.5 * (before.at_m + behind.at_m), middle);
    (inside(middle) == inside(before) ? before : behind) = std::move(middle);
  }
  const bool outside_is_fluid = outward(finder_.surface(target), {1, 0, 0}).x > 0;
  const bool enters_tissue = inside(behind) == outside_is_fluid;
  if (enters_tissue != (edge_ == render::EdgeSign::rising)) return std::nullopt;
  const auto there = finder_.target_distance(target, behind.rest_m);
  // Outside the box a grid may be cut off, where signs change without a surface. Between two sticks
  // tissue may have moved by more than its narrow band.
  if (!there && before.stick == behind.stick) return std::nullopt;
  glm::dvec3 normal = inside(behind) ? -ray.direction : ray.direction;
  if (there) {
    normal = glm::normalize(gradient_at_stick(ray.at(behind.at_m), behind.stick, there->gradient));
  }
  return SurfaceCrossing{behind.at_m, outward(finder_.surface(target), normal)};
}

}  // namespace wobblebench::bench
