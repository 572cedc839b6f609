#include "bench/evaluation/truth/truth.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>

#include "bench/evaluation/truth/scanned_surfaces.h"
#include "phantoms/label_finder.h"

namespace wobblebench::bench {

namespace {

/// Fills in pixels, for one thread.
class TruthTracer {
 public:
  TruthTracer(const hw::AcquisitionPlan& plan,
              const render::View& view,
              const ScannedSurfaces& surfaces,
              const phantoms::LabelFinder& labels)
      : plan_(plan),
        geometry_(plan.geometry()),
        view_(view),
        // Copies: their OpenVDB accessors must not be shared between threads.
        surfaces_(surfaces),
        labels_(labels) {}

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
    const hw::PolarPoint polar = geometry_.to_polar(at);
    const TruthKind kind = !in_field(plan_, polar)    ? TruthKind::outside_field
                           : incidence > kGrazing_rad ? TruthKind::grazing
                                                      : TruthKind::surface;
    truth.kind.at(column, row) = kind;
    if (kind == TruthKind::surface) truth.depth_m.at(column, row) = depth_m;
    truth.normal.at(column, row) = hit->outward;
    truth.crossing_m.at(column, row) = depth_m;
    truth.range_m.at(column, row) = static_cast<float>(polar.range_m);
    truth.incidence_rad.at(column, row) = static_cast<float>(incidence);
    truth.part.at(column, row) = labels_.on_surface(hit->surface, surfaces_.to_rest(at, stick));
  }

 private:
  const hw::AcquisitionPlan& plan_;
  hw::ProbeGeometry geometry_;
  const render::View& view_;
  ScannedSurfaces surfaces_;
  phantoms::LabelFinder labels_;
};

Truth nothing_in_view(int size) {
  Truth truth{{size, size, kNoSurface}, {size, size}, {size, size, TruthKind::none}};
  truth.crossing_m = truth.range_m = truth.incidence_rad = {size, size, kNoSurface};
  truth.part = {size, size, 0};
  return truth;
}

bool is_of_face(std::uint8_t label) {
  return label >= static_cast<std::uint8_t>(phantoms::Part::forehead) &&
         label <= static_cast<std::uint8_t>(phantoms::Part::cleft);
}

/// The truth's depths are floats.
bool is_within(const render::VolumeOfInterest& box, const glm::dvec3& at) {
  constexpr double kRounding_m = 1e-7;
  const glm::dvec3 off = glm::abs(at - box.center_m), half = 0.5 * box.size_m + kRounding_m;
  return off.x <= half.x && off.y <= half.y && off.z <= half.z;
}

}  // namespace

bool in_field(const hw::AcquisitionPlan& plan, const hw::PolarPoint& point) {
  const auto& a = plan.acquisition();
  return point.range_m >= 0 && point.range_m <= a.depth_m &&
         std::abs(point.theta_rad) <= a.sector_rad / 2 && std::abs(point.phi_rad) <= a.fan_rad / 2;
}

std::vector<phantoms::LabelName> labels_in(std::span<const std::uint8_t> labels,
                                           const phantoms::Phantom& phantom) {
  std::array<bool, 256> is_there{};
  for (const std::uint8_t label : labels) is_there[label] = true;
  std::vector<phantoms::LabelName> names = phantoms::label_names(phantom);
  std::erase_if(names, [&](const auto& name) { return !is_there[name.label]; });
  return names;
}

Truth trace_truth(const phantoms::PlacedPhantom& subject,
                  const hw::AcquisitionPlan& plan,
                  const render::View& view,
                  std::uint32_t volume) {
  const int size = view.camera.image_size;
  Truth truth = nothing_in_view(size);
  const ScannedSurfaces surfaces(subject, plan, view, 0, volume);
  const phantoms::LabelFinder labels(subject.phantom);
  tbb::parallel_for(tbb::blocked_range<int>(0, size), [&](const tbb::blocked_range<int>& rows) {
    const TruthTracer tracer(plan, view, surfaces, labels);
    for (int row = rows.begin(); row < rows.end(); ++row) {
      for (int column = 0; column < size; ++column) tracer.trace(column, row, truth);
    }
  });
  if (subject.phantom.parts() != nullptr) {
    truth.parts = labels_in(truth.part.pixels, subject.phantom);
  }
  return truth;
}

double cut_by_box_percent(const phantoms::PlacedPhantom& subject,
                          const hw::AcquisitionPlan& plan,
                          const render::View& view,
                          std::uint32_t volume) {
  constexpr int kSide = 96;
  constexpr double kWider = 2;
  render::View wide = view;
  wide.box.size_m *= kWider;
  wide.camera.width_m *= kWider;
  wide.camera.plane_distance_m *= kWider;
  wide.camera.image_size = kSide;
  const Truth truth = trace_truth(subject, plan, wide, volume);
  double all_m2 = 0, cut_m2 = 0;
  for (int row = 0; row < kSide; ++row) {
    for (int column = 0; column < kSide; ++column) {
      if (truth.kind.at(column, row) != TruthKind::surface) continue;
      if (subject.phantom.parts() != nullptr && !is_of_face(truth.part.at(column, row))) continue;
      const double area_m2 = pixel_area_m2(truth, wide.camera, column, row);
      const glm::dvec3 at =
          wide.camera.ray(column, row).at(static_cast<double>(truth.depth_m.at(column, row)));
      all_m2 += area_m2;
      if (!is_within(view.box, at)) cut_m2 += area_m2;
    }
  }
  return 100 * cut_m2 / all_m2;
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
