#include "bench/evaluation/registration/registration.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "bench/evaluation/truth/scanned_surfaces.h"

namespace wobblebench::bench {

namespace {

/// Additional reach for points that move away from the surface during the fit.
constexpr double kDrift_m = 1e-3;

std::vector<MeasuredPoint> measured_points(const Image<float>& depth_m,
                                           const hw::ProbeGeometry& assumed,
                                           const render::Camera& camera,
                                           const ScannedSurfaces& target,
                                           int max_points,
                                           int& sampled) {
  const double per_point = static_cast<double>(depth_m.pixels.size()) / max_points;
  const int stride = std::max(1, static_cast<int>(std::ceil(std::sqrt(per_point))));
  std::vector<MeasuredPoint> points;
  for (int row = stride / 2; row < depth_m.height; row += stride) {
    for (int column = stride / 2; column < depth_m.width; column += stride) {
      const double depth = static_cast<double>(depth_m.at(column, row));
      if (!std::isfinite(depth)) continue;
      ++sampled;
      const hw::Ray ray = camera.ray(column, row);
      const hw::StickIndex fired = target.stick_at(ray.at(depth));
      const auto distance = target.distance(ray.at(depth), fired);
      if (!distance || std::abs(distance->value_m) > kFarPoint_m) continue;
      points.push_back({assumed.to_polar(ray.at(depth)),
                        ray.direction,
                        fired,
                        error_block(camera, column, row)});
    }
  }
  return points;
}

}  // namespace

std::int64_t error_block(const render::Camera& camera, int column, int row) {
  const double pixels = std::max(1.0, kErrorBlock_m / camera.pixel_m());
  return static_cast<std::int64_t>(row / pixels) * (std::int64_t{1} << 20) +
         static_cast<std::int64_t>(column / pixels);
}

struct SurfaceRegistration::State {
  hw::AcquisitionPlan plan;
  render::Camera camera;
  ScannedSurfaces target;
};

SurfaceRegistration::SurfaceRegistration(const phantoms::PlacedPhantom& subject,
                                         const hw::AcquisitionPlan& plan,
                                         const render::View& view,
                                         std::uint32_t volume)
    : state_(new State{plan, view.camera, {subject, plan, view, kFarPoint_m + kDrift_m, volume}}) {}

SurfaceRegistration::~SurfaceRegistration() = default;

Registration SurfaceRegistration::fit(const Image<float>& depth_m,
                                      const RegistrationPriors& priors,
                                      int max_points) const {
  return fit(depth_m, state_->plan, priors, max_points);
}

Registration SurfaceRegistration::fit(const Image<float>& depth_m,
                                      const hw::AcquisitionPlan& assumed,
                                      const RegistrationPriors& priors,
                                      int max_points) const {
  int sampled = 0;
  const auto points = measured_points(
      depth_m, assumed.geometry(), state_->camera, state_->target, max_points, sampled);
  const auto distance_to = [&](const glm::dvec3& position_m, const hw::StickIndex& fired) {
    return state_->target.distance(position_m, fired);
  };
  Registration result = fit_probe(points, distance_to, assumed.geometry(), priors);
  result.sampled = sampled;
  return result;
}

Registration register_surface(const Image<float>& depth_m,
                              const phantoms::PlacedPhantom& subject,
                              const hw::AcquisitionPlan& plan,
                              const render::View& view,
                              const RegistrationPriors& priors,
                              int max_points,
                              std::uint32_t volume) {
  return SurfaceRegistration(subject, plan, view, volume).fit(depth_m, priors, max_points);
}

}  // namespace wobblebench::bench
