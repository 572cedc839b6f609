#include "bench/evaluation/registration/registration.h"

#include <algorithm>
#include <cmath>
#include <limits>
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

/// Signed distances at which a surface is known to be found, by where they are in a picture.
class ExpectedDistances {
 public:
  ExpectedDistances(const Image<float>& expected_m, const render::Camera& camera)
      : expected_m_(expected_m),
        camera_(camera),
        reach_(std::max(1, static_cast<int>(std::lround(kPlay_m / camera.pixel_m())))) {}

  /// Whether a point stays among known pixels while the fit moves it.
  bool known_about(int column, int row) const {
    if (column < reach_ || row < reach_) return false;
    if (column + reach_ >= expected_m_.width || row + reach_ >= expected_m_.height) return false;
    for (int j = row - reach_; j <= row + reach_; ++j) {
      for (int i = column - reach_; i <= column + reach_; ++i) {
        if (!std::isfinite(expected_m_.at(i, j))) return false;
      }
    }
    return true;
  }

  using Distance = phantoms::SurfaceFinder::Distance;
  /// The distance less what is expected there, with its gradient across the view.
  std::optional<Distance> take_off(std::optional<Distance> distance,
                                   const glm::dvec3& position_m) const {
    const double expected = at(position_m);
    if (!distance || !std::isfinite(expected)) return {};
    distance->value_m -= expected;
    const double h = camera_.pixel_m();
    for (const glm::dvec3& across : {camera_.right, camera_.down}) {
      const double slope = (at(position_m + h * across) - at(position_m - h * across)) / (2 * h);
      if (std::isfinite(slope)) distance->gradient -= slope * across;
    }
    return distance;
  }

 private:
  /// Bilinear; NaN where a neighbour is unknown.
  double at(const glm::dvec3& position_m) const {
    const auto point = camera_.project(position_m);
    const int column = static_cast<int>(std::floor(point.column));
    const int row = static_cast<int>(std::floor(point.row));
    const bool inside =
        column >= 0 && row >= 0 && column + 1 < expected_m_.width && row + 1 < expected_m_.height;
    if (!inside) return std::numeric_limits<double>::quiet_NaN();
    const double u = point.column - column, v = point.row - row;
    const auto value = [&](int i, int j) {
      return static_cast<double>(expected_m_.at(column + i, row + j));
    };
    return (1 - v) * ((1 - u) * value(0, 0) + u * value(1, 0)) +
           v * ((1 - u) * value(0, 1) + u * value(1, 1));
  }

  /// Errors of the probe move points across the view by about 2 mm.
  static constexpr double kPlay_m = 2.5e-3;

  const Image<float>& expected_m_;
  const render::Camera& camera_;
  int reach_;
};

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

Image<float> SurfaceRegistration::distances(const Image<float>& depth_m) const {
  Image<float> result(depth_m.width, depth_m.height, kNoSurface);
  const int all = static_cast<int>(depth_m.pixels.size());
  for_each_sampled_pixel(depth_m, all, [&](int column, int row) {
    const auto found = state_->found(depth_m, column, row);
    if (found) result.at(column, row) = static_cast<float>(found->distance_m);
  });
  return result;
}

Registration SurfaceRegistration::fit_difference(const Image<float>& depth_m,
                                                 const Image<float>& expected_m,
                                                 const RegistrationPriors& priors,
                                                 int max_points) const {
  const ExpectedDistances expected(expected_m, state_->camera);
  std::vector<MeasuredPoint> points;
  int sampled = 0;
  for_each_sampled_pixel(depth_m, max_points, [&](int column, int row) {
    ++sampled;
    if (!expected.known_about(column, row)) return;
    if (const auto found = state_->found(depth_m, column, row)) points.push_back(found->point);
  });
  const auto beyond_expected = [&](const glm::dvec3& position_m, const hw::StickIndex& fired) {
    return expected.take_off(state_->target.distance(position_m, fired), position_m);
  };
  Registration result = fit_probe(points, beyond_expected, state_->plan.geometry(), priors);
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
