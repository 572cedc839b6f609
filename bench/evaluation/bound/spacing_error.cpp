#include "bench/evaluation/bound/spacing_error.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "base/parallel.h"
#include "base/statistics.h"
#include "bench/evaluation/truth/scanned_surfaces.h"
#include "bench/evaluation/truth/truth.h"

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

enum class Support : std::uint8_t { none, hidden, outside, parted, whole };

struct PixelError {
  Support support = Support::none;  ///< none: not counted
  double error_m = 0;               ///< along the picture's ray; only if parted or whole
};

/// Threads must not share one.
class SticksAbout {
 public:
  SticksAbout(const hw::AcquisitionPlan& plan, const StickRanges& sticks)
      : plan_(plan),
        geometry_(plan.geometry()),
        ranges_m_(sticks.ranges_m),
        surfaces_(sticks.surfaces) {}

  /// At the true point of a picture's ray.
  PixelError error(const hw::Ray& ray, double depth_m, const glm::dvec3& normal) const {
    const hw::PolarPoint truth = geometry_.to_polar(ray.at(depth_m));
    const auto seen_m = range_m(truth.theta_rad, truth.phi_rad);
    if (!seen_m || std::abs(*seen_m - truth.range_m) > kSamePoint_m) return {Support::hidden};
    const auto& a = plan_.acquisition();
    const auto line =
        between(truth.theta_rad, plan_.theta_rad(0), plan_.theta_step_rad(), a.sticks_per_frame);
    const auto frame =
        between(truth.phi_rad, plan_.frame_phi_rad(0), plan_.phi_step_rad(), a.frames_per_volume);
    if (!line || !frame) return {Support::outside};
    const std::array<double, 4> four = corners(*line, *frame);
    if (std::ranges::any_of(four, [](double r) { return std::isnan(r); })) {
      return {Support::outside};
    }
    const double near = std::lerp(four[0], four[1], line->share);
    const double far = std::lerp(four[2], four[3], line->share);
    const double range_error_m = std::lerp(near, far, frame->share) - truth.range_m;
    const glm::dvec3 stick = geometry_.stick(truth.theta_rad, truth.phi_rad).direction;
    const double along_ray = glm::dot(ray.direction, normal);
    return {joined(truth, *line, *frame) ? Support::whole : Support::parted,
            range_error_m * glm::dot(stick, normal) /
                std::copysign(std::max(std::abs(along_ray), kLeastCosine), along_ray)};
  }

 private:
  std::array<double, 4> corners(const Between& line, const Between& frame) const {
    const auto at = [&](int l, int f) {
      return static_cast<double>(ranges_m_.at(line.first + l, frame.first + f));
    };
    return {at(0, 0), at(1, 0), at(0, 1), at(1, 1)};
  }

  std::optional<double> range_m(double theta_rad, double phi_rad) const {
    const auto hit = surfaces_.first(geometry_.stick(theta_rad, phi_rad));
    return hit ? std::optional(hit->distance_m) : std::nullopt;
  }

  /// Whether the surface continues from the true point to all four sticks.
  bool joined(const hw::PolarPoint& truth, const Between& line, const Between& frame) const {
    for (int corner = 0; corner < 4; ++corner) {
      const double theta_rad = plan_.theta_rad(line.first + corner % 2);
      const double phi_rad = plan_.frame_phi_rad(frame.first + corner / 2);
      if (!runs_on(truth, theta_rad, phi_rad)) return false;
    }
    return true;
  }

  bool runs_on(const hw::PolarPoint& truth, double theta_rad, double phi_rad) const {
    double last_m = truth.range_m;
    glm::dvec3 last = geometry_.stick(truth.theta_rad, truth.phi_rad).at(last_m);
    for (int traced = 1; traced <= kTracedSticks; ++traced) {
      const double share = double(traced) / kTracedSticks;
      const hw::Ray stick = geometry_.stick(std::lerp(truth.theta_rad, theta_rad, share),
                                            std::lerp(truth.phi_rad, phi_rad, share));
      const auto hit = surfaces_.first(stick);
      if (!hit) return false;
      const double aside_m = glm::length(stick.at(last_m) - last);
      if (std::abs(hit->distance_m - last_m) > aside_m * std::tan(kGrazing_rad)) return false;
      last_m = hit->distance_m;
      last = stick.at(last_m);
    }
    return true;
  }

  const hw::AcquisitionPlan& plan_;
  hw::ProbeGeometry geometry_;
  const Image<float>& ranges_m_;
  ScannedSurfaces surfaces_;
};

Image<PixelError> pixel_errors(const Truth& truth,
                               const render::Camera& camera,
                               const hw::AcquisitionPlan& plan,
                               const StickRanges& sticks,
                               const CountedPixel& counted) {
  Image<PixelError> errors(truth.kind.width, truth.kind.height);
  parallel_ranges(errors.height, 0, [&](int first, int last) {
    const SticksAbout about(plan, sticks);
    for (int row = first; row < last; ++row) {
      for (int column = 0; column < errors.width; ++column) {
        if (truth.kind.at(column, row) != TruthKind::surface || !counted(column, row)) continue;
        errors.at(column, row) = about.error(camera.ray(column, row),
                                             static_cast<double>(truth.depth_m.at(column, row)),
                                             glm::dvec3(truth.normal.at(column, row)));
      }
    }
  });
  return errors;
}

}  // namespace

StickRanges stick_ranges_m(const phantoms::PlacedPhantom& subject,
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
  return {std::move(ranges_m), shared};
}

SpacingError spacing_error(const Truth& truth,
                           const render::Camera& camera,
                           const hw::AcquisitionPlan& plan,
                           const StickRanges& sticks,
                           const CountedPixel& counted) {
  const Image<PixelError> errors = pixel_errors(truth, camera, plan, sticks, counted);
  SpacingError result{.map_m = {errors.width, errors.height, kNoSurface}};
  std::vector<double> whole, all;
  for (std::size_t i = 0; i < errors.pixels.size(); ++i) {
    const PixelError& pixel = errors.pixels[i];
    if (pixel.support == Support::hidden) ++result.hidden;
    if (pixel.support == Support::outside) ++result.outside;
    if (pixel.support == Support::parted) ++result.parted;
    if (pixel.support < Support::parted) continue;
    all.push_back(std::abs(pixel.error_m));
    if (pixel.support == Support::parted) continue;
    whole.push_back(std::abs(pixel.error_m));
    result.map_m.pixels[i] = static_cast<float>(pixel.error_m);
  }
  result.n = static_cast<int>(whole.size());
  result.unsupported = result.hidden + result.outside + result.parted;
  result.rms_m = root_mean_square(whole);
  result.with_parted_rms_m = root_mean_square(all);
  result.p95_m = quantile(whole, 0.95);
  return result;
}

}  // namespace wobblebench::bench
