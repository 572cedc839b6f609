#include "bench/evaluation/registration/registration.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "bench/evaluation/truth/scanned_surfaces.h"

namespace wobblebench::bench {

namespace {

/// Additional reach for points that move away from the surface during the fit.
constexpr double kDrift_m = 1e-3;

/// Pixels on a regular grid, at most about `max_points` of the picture.
template <class Body>
void for_each_sampled_pixel(const Image<float>& depth_m, int max_points, const Body& body) {
  const double per_point = static_cast<double>(depth_m.pixels.size()) / max_points;
  const int stride = std::max(1, static_cast<int>(std::ceil(std::sqrt(per_point))));
  for (int row = stride / 2; row < depth_m.height; row += stride) {
    for (int column = stride / 2; column < depth_m.width; column += stride) {
      if (std::isfinite(depth_m.at(column, row))) body(column, row);
    }
  }
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

  /// The point of a pixel and its signed distance; none where no surface is near.
  struct Found {
    MeasuredPoint point;
    double distance_m;
  };
  std::optional<Found> found(const Image<float>& depth_m, int column, int row) const {
    const hw::Ray ray = camera.ray(column, row);
    const glm::dvec3 position = ray.at(static_cast<double>(depth_m.at(column, row)));
    const hw::StickIndex fired = target.stick_at(position);
    const auto distance = target.distance(position, fired);
    if (!distance || std::abs(distance->value_m) > kFarPoint_m) return {};
    return Found{{plan.geometry().to_polar(position),
                  ray.direction,
                  fired,
                  error_block(camera, column, row)},
                 distance->value_m};
  }

  Registration fit(const std::vector<MeasuredPoint>& points,
                   int sampled,
                   const RegistrationPriors& priors) const {
    const auto distance_to = [&](const glm::dvec3& position_m, const hw::StickIndex& fired) {
      return target.distance(position_m, fired);
    };
    Registration result = fit_probe(points, distance_to, plan.geometry(), priors);
    result.sampled = sampled;
    return result;
  }
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
  std::vector<MeasuredPoint> points;
  int sampled = 0;
  for_each_sampled_pixel(depth_m, max_points, [&](int column, int row) {
    ++sampled;
    if (const auto found = state_->found(depth_m, column, row)) points.push_back(found->point);
  });
  return state_->fit(points, sampled, priors);
}

Image<float> SurfaceRegistration::distances(const Image<float>& depth_m, int max_points) const {
  Image<float> result(depth_m.width, depth_m.height, kNoSurface);
  for_each_sampled_pixel(depth_m, max_points, [&](int column, int row) {
    const auto found = state_->found(depth_m, column, row);
    if (found) result.at(column, row) = static_cast<float>(found->distance_m);
  });
  return result;
}

Registration SurfaceRegistration::fit_difference(const Image<float>& depth_m,
                                                 const Image<float>& expected_m,
                                                 const RegistrationPriors& priors,
                                                 int max_points) const {
  std::vector<MeasuredPoint> points;
  int sampled = 0;
  for_each_sampled_pixel(depth_m, max_points, [&](int column, int row) {
    ++sampled;
    const auto found = state_->found(depth_m, column, row);
    if (!found || !std::isfinite(expected_m.at(column, row))) return;
    points.push_back(found->point);
    points.back().expected_m = static_cast<double>(expected_m.at(column, row));
  });
  return state_->fit(points, sampled, priors);
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
