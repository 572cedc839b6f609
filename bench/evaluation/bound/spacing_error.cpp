#include "bench/evaluation/bound/spacing_error.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <optional>
#include <vector>

#include "base/parallel.h"
#include "base/statistics.h"
#include "bench/evaluation/truth/pixel_area.h"
#include "bench/evaluation/truth/scanned_surfaces.h"

namespace wobblebench::bench {

namespace {

/// Between two of `count` sticks or frames: the first of them and the share of the second.
struct Between {
  int first = 0;
  double share = 0;
};

std::optional<Between> between(double angle_rad, double first_rad, double step_rad, int count) {
  const double at = (angle_rad - first_rad) / step_rad;
  if (count < 2 || !(at >= 0 && at <= count - 1)) return std::nullopt;
  const int first = std::min(static_cast<int>(at), count - 2);
  return Between{first, at - first};
}

/// Of the surface through the four sticks; none where they do not meet that of the true point.
std::optional<double> range_between(const Image<float>& ranges_m,
                                    const Between& line,
                                    const Between& frame,
                                    double true_m) {
  const auto at = [&](int l, int f) {
    return static_cast<double>(ranges_m.at(line.first + l, frame.first + f));
  };
  const std::array<double, 4> four{at(0, 0), at(1, 0), at(0, 1), at(1, 1)};
  if (std::ranges::any_of(four, [](double range_m) { return std::isnan(range_m); })) return {};
  const auto [least, most] = std::ranges::minmax(four);
  if (most - least > kOneSurface_m) return std::nullopt;
  if (true_m < least - kBulge_m || true_m > most + kBulge_m) return std::nullopt;
  const double near = std::lerp(four[0], four[1], line.share);
  const double far = std::lerp(four[2], four[3], line.share);
  return std::lerp(near, far, frame.share);
}

class SticksAbout {
 public:
  SticksAbout(const hw::AcquisitionPlan& plan, const Image<float>& ranges_m)
      : plan_(plan), geometry_(plan.geometry()), ranges_m_(ranges_m) {}

  /// Error along a picture's ray at the true point.
  std::optional<double> error_m(const hw::Ray& ray,
                                double depth_m,
                                const glm::dvec3& normal) const {
    const hw::PolarPoint truth = geometry_.to_polar(ray.at(depth_m));
    const auto& a = plan_.acquisition();
    const auto line =
        between(truth.theta_rad, plan_.theta_rad(0), plan_.theta_step_rad(), a.sticks_per_frame);
    const auto frame =
        between(truth.phi_rad, plan_.frame_phi_rad(0), plan_.phi_step_rad(), a.frames_per_volume);
    if (!line || !frame) return std::nullopt;
    const auto range_m = range_between(ranges_m_, *line, *frame, truth.range_m);
    if (!range_m) return std::nullopt;
    const glm::dvec3 stick = geometry_.stick(truth.theta_rad, truth.phi_rad).direction;
    const double along_ray = glm::dot(ray.direction, normal);
    return (*range_m - truth.range_m) * glm::dot(stick, normal) /
           std::copysign(std::max(std::abs(along_ray), kLeastCosine), along_ray);
  }

 private:
  const hw::AcquisitionPlan& plan_;
  hw::ProbeGeometry geometry_;
  const Image<float>& ranges_m_;
};

}  // namespace

Image<float> stick_ranges_m(const phantoms::PlacedPhantom& subject,
                            const hw::AcquisitionPlan& plan,
                            const render::View& view,
                            std::uint32_t volume) {
  const auto& a = plan.acquisition();
  Image<float> ranges_m(a.sticks_per_frame, a.frames_per_volume, kNoSurface);
  const ScannedSurfaces shared(subject, plan, view, 0, volume);
  const hw::ProbeGeometry geometry = plan.geometry();
  parallel_ranges(a.frames_per_volume, 0, [&](int first, int last) {
    // Its OpenVDB accessors must not be shared between threads.
    // NOLINTNEXTLINE(performance-unnecessary-copy-initialization)
    const ScannedSurfaces surfaces(shared);
    for (int frame = first; frame < last; ++frame) {
      for (int line = 0; line < a.sticks_per_frame; ++line) {
        const hw::StickIndex index{
            volume, static_cast<std::uint32_t>(frame), static_cast<std::uint32_t>(line)};
        const auto hit =
            surfaces.first(geometry.stick(plan.theta_rad(line), plan.motor_angle_rad(index)));
        if (hit) ranges_m.at(line, frame) = static_cast<float>(hit->distance_m);
      }
    }
  });
  return ranges_m;
}

SpacingError spacing_error(const Truth& truth,
                           const render::Camera& camera,
                           const hw::AcquisitionPlan& plan,
                           const Image<float>& ranges_m,
                           const CountedPixel& counted) {
  const int width = truth.kind.width, height = truth.kind.height;
  SpacingError result{.map_m = {width, height, kNoSurface}};
  const SticksAbout sticks(plan, ranges_m);
  std::vector<double> magnitudes;
  double squares = 0;
  for (int row = 0; row < height; ++row) {
    for (int column = 0; column < width; ++column) {
      if (truth.kind.at(column, row) != TruthKind::surface || !counted(column, row)) continue;
      const auto error_m = sticks.error_m(camera.ray(column, row),
                                          static_cast<double>(truth.depth_m.at(column, row)),
                                          glm::dvec3(truth.normal.at(column, row)));
      if (!error_m) {
        ++result.unsupported;
        continue;
      }
      result.map_m.at(column, row) = static_cast<float>(*error_m);
      magnitudes.push_back(std::abs(*error_m));
      squares += *error_m * *error_m;
    }
  }
  result.n = static_cast<int>(magnitudes.size());
  result.rms_m =
      result.n > 0 ? std::sqrt(squares / result.n) : std::numeric_limits<double>::quiet_NaN();
  result.p95_m = quantile_nearest(magnitudes, 0.95);
  return result;
}

}  // namespace wobblebench::bench
