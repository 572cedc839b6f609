#include "bench/evaluation/truth/truth.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <glm/geometric.hpp>

#include "base/duration.h"
#include "bench/evaluation/truth/scanned_surfaces.h"

namespace wobblebench::bench {

namespace {

/// Fills in pixels, for one thread.
class TruthTracer {
 public:
  TruthTracer(const phantoms::PlacedPhantom& subject,
              const hw::AcquisitionPlan& plan,
              const render::View& view,
              const ScannedSurfaces& surfaces)
      : subject_(subject),
        plan_(plan),
        geometry_(plan.geometry()),
        view_(view),
        // A copy: its OpenVDB accessors must not be shared between threads.
        surfaces_(surfaces) {}

  void trace(int column, int row, Truth& truth) const {
    const hw::Ray ray = view_.camera.ray(column, row);
    const auto hit = surfaces_.first(ray);
    if (!hit) return;
    const glm::dvec3 at = ray.at(hit->distance_m);
    const hw::StickIndex stick = surfaces_.stick_at(at);
    const glm::dvec3 along =
        geometry_.stick(plan_.theta_rad(static_cast<int>(stick.line)), plan_.motor_angle_rad(stick))
            .direction;
    const double towards = view_.edge == render::EdgeSign::rising ? -1 : 1;
    const double incidence =
        std::acos(std::clamp(towards * glm::dot(along, hit->outward), -1.0, 1.0));
    const auto depth_m = static_cast<float>(hit->distance_m);
    const TruthKind kind = !in_field(at)              ? TruthKind::outside_field
                           : incidence > kGrazing_rad ? TruthKind::grazing
                                                      : TruthKind::surface;
    truth.kind.at(column, row) = kind;
    if (kind == TruthKind::surface) truth.depth_m.at(column, row) = depth_m;
    truth.normal.at(column, row) = hit->outward;
    truth.crossing_m.at(column, row) = depth_m;
    truth.range_m.at(column, row) = static_cast<float>(geometry_.to_polar(at).range_m);
    truth.incidence_rad.at(column, row) = static_cast<float>(incidence);
    truth.feature.at(column, row) = feature_at(at, stick);
  }

 private:
  bool in_field(const glm::dvec3& position) const {
    const hw::PolarPoint p = geometry_.to_polar(position);
    const auto& a = plan_.acquisition();
    return p.range_m >= 0 && p.range_m <= a.depth_m && std::abs(p.theta_rad) <= a.sector_rad / 2 &&
           std::abs(p.phi_rad) <= a.fan_rad / 2;
  }

  std::uint8_t feature_at(const glm::dvec3& position, const hw::StickIndex& stick) const {
    const auto& features = subject_.phantom.features();
    if (features.empty()) return 0;
    const double time_s = to_seconds(plan_.stick_time(plan_.sequence(stick)).time_since_epoch());
    const glm::dvec3 rest_m = subject_.to_rest(position, time_s);
    const auto found = std::find_if(
        features.begin(), features.end(), [&](const auto& f) { return f.contains(rest_m); });
    return static_cast<std::uint8_t>(found - features.begin());
  }

  const phantoms::PlacedPhantom& subject_;
  const hw::AcquisitionPlan& plan_;
  hw::ProbeGeometry geometry_;
  const render::View& view_;
  ScannedSurfaces surfaces_;
};

Truth nothing_in_view(int size, const phantoms::Phantom& phantom) {
  Truth truth{{size, size, kNoSurface}, {size, size}, {size, size, TruthKind::none}};
  truth.crossing_m = truth.range_m = truth.incidence_rad = {size, size, kNoSurface};
  truth.feature = {size, size, static_cast<std::uint8_t>(phantom.features().size())};
  for (const auto& feature : phantom.features()) truth.features.push_back(feature.name);
  return truth;
}

}  // namespace

Truth trace_truth(const phantoms::PlacedPhantom& subject,
                  const hw::AcquisitionPlan& plan,
                  const render::View& view,
                  std::uint32_t volume) {
  const int size = view.camera.image_size;
  Truth truth = nothing_in_view(size, subject.phantom);
  const ScannedSurfaces surfaces(subject, plan, view, 0, volume);
  tbb::parallel_for(tbb::blocked_range<int>(0, size), [&](const tbb::blocked_range<int>& rows) {
    const TruthTracer tracer(subject, plan, view, surfaces);
    for (int row = rows.begin(); row < rows.end(); ++row) {
      for (int column = 0; column < size; ++column) tracer.trace(column, row, truth);
    }
  });
  return truth;
}

double pixel_area_m2(const render::Camera& camera,
                     const hw::Ray& ray,
                     double depth_m,
                     const glm::dvec3& normal) {
  const double cosine = std::abs(glm::dot(ray.direction, normal));
  const double pixel_m2 = camera.pixel_m() * camera.pixel_m();
  double across_m2 = pixel_m2;  // perpendicular to the ray
  if (camera.projection == render::Projection::perspective) {
    const double off_axis = glm::dot(ray.direction, camera.forward);
    const double scale = depth_m / camera.eye_distance_m;
    across_m2 = pixel_m2 * scale * scale * off_axis * off_axis * off_axis;
  }
  return across_m2 / std::max(cosine, kLeastCosine);
}

double pixel_area_m2(const Truth& truth, const render::Camera& camera, int column, int row) {
  return pixel_area_m2(camera,
                       camera.ray(column, row),
                       static_cast<double>(truth.any_depth_m(column, row)),
                       truth.normal.at(column, row));
}

}  // namespace wobblebench::bench
