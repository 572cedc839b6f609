#include "bench/evaluation/truth/labels.h"

#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>

#include "base/duration.h"

namespace wobblebench::bench {

namespace {

/// What a stick enters nearer than this before a point is the point itself …
constexpr double kOwnPoint_m = 0.3e-3;
/// … and if it is the surface that the point is on, nearer than this: the rim of a groove that is
/// narrower than any beam hides nothing.
constexpr double kOwnRim_m = 1e-3;
/// What a pixel shows at a depth farther than this from that of a point in it is another surface.
constexpr double kOwnSkin_m = 3e-3;
/// How near to a surface a point lies that is on it.
constexpr double kOnSurface_m = 0.1e-3;
/// Where it is asked what a crossing was entered from; more than the error of a crossing.
constexpr double kJustBefore_m = 0.1e-3;

/// The box holds the whole way of the sound: from the probe's face to the view's box.
render::View with_way_of_sound(render::View view, const hw::AcquisitionPlan& plan) {
  const hw::ProbeGeometry geometry = plan.geometry();
  const auto& a = plan.acquisition();
  glm::dvec3 low = view.box.center_m - 0.5 * view.box.size_m;
  glm::dvec3 high = view.box.center_m + 0.5 * view.box.size_m;
  for (const double theta : {-0.5, 0.0, 0.5}) {
    for (const double phi : {-0.5, 0.0, 0.5}) {
      const glm::dvec3 face_m = geometry.to_cartesian({0, theta * a.sector_rad, phi * a.fan_rad});
      low = glm::min(low, face_m);
      high = glm::max(high, face_m);
    }
  }
  view.box.center_m = 0.5 * (low + high);
  view.box.size_m = high - low;
  view.edge = render::EdgeSign::rising;
  return view;
}

}  // namespace

SightLines::SightLines(const phantoms::PlacedPhantom& subject,
                       const hw::AcquisitionPlan& plan,
                       const render::View& view,
                       std::uint32_t volume)
    : phantom_(subject.phantom),
      geometry_(plan.geometry()),
      surfaces_(subject, plan, with_way_of_sound(view, plan), 0, volume),
      labels_(subject.phantom) {}

bool SightLines::is_fluid(const glm::dvec3& position_m) const {
  const int surface = labels_.enclosing(at_rest(position_m));
  const phantoms::MaterialIndex material =
      surface < 0 ? phantom_.background()
                  : phantom_.surfaces()[static_cast<std::size_t>(surface)].inside;
  return phantom_.materials()[static_cast<std::size_t>(material)].backscatter_db <=
         kTissueBackscatter_db;
}

std::uint8_t SightLines::before(const glm::dvec3& position_m) const {
  const hw::PolarPoint polar = geometry_.to_polar(position_m);
  hw::Ray left = geometry_.stick(polar.theta_rad, polar.phi_rad);
  double left_m = polar.range_m;
  while (const auto entered = surfaces_.first(left)) {
    if (entered->distance_m > left_m - kOwnPoint_m) return 0;
    const bool is_rim = entered->distance_m > left_m - kOwnRim_m &&
                        labels_.distance_m(entered->surface, at_rest(position_m)) < kOnSurface_m;
    const glm::dvec3 at = left.at(entered->distance_m);
    if (!is_rim && is_fluid(at - kJustBefore_m * left.direction)) {
      return labels_.on_surface(entered->surface, at_rest(at));
    }
    const double beyond_m = entered->distance_m + kJustBefore_m;
    left.origin = left.at(beyond_m);
    left_m -= beyond_m;
  }
  return 0;
}

glm::dvec3 SightLines::at_rest(const glm::dvec3& position_m) const {
  return surfaces_.to_rest(position_m, surfaces_.stick_at(position_m));
}

namespace {

class LandmarkFinder {
 public:
  LandmarkFinder(const ResolvedScene& scene,
                 const Truth& truth,
                 const StickReach& reach,
                 std::uint32_t volume)
      : subject_(scene.subject().value()),
        plan_(scene.plan()),
        geometry_(plan_.geometry()),
        camera_(scene.view().camera),
        box_(scene.view().box),
        truth_(truth),
        reach_(reach),
        sight_(subject_, plan_, scene.view(), volume),
        surfaces_(subject_, plan_, scene.view(), 0, volume),
        volume_(volume) {}

  SeenLandmark find(const phantoms::Landmark& landmark) const {
    SeenLandmark seen{.name = landmark.name};
    seen.position_m = when_imaged(landmark.position_m);
    seen.at = camera_.project(seen.position_m);
    seen.in_picture = is_in_picture(seen.at);
    seen.kind = kind_of(seen.position_m);
    // A motor that leaves its plan is known to the truth alone.
    if (seen.in_picture &&
        truth_.kind.at(column(seen.at), row(seen.at)) == TruthKind::outside_field) {
      seen.kind = TruthKind::outside_field;
    }
    seen.before = sight_.before(seen.position_m);
    return seen;
  }

 private:
  static int column(const render::PicturePoint& at) {
    return static_cast<int>(std::lround(at.column));
  }
  static int row(const render::PicturePoint& at) { return static_cast<int>(std::lround(at.row)); }

  double time_s(const hw::StickIndex& stick) const {
    return to_seconds(plan_.stick_time(plan_.sequence(stick)).time_since_epoch());
  }

  /// Where it is when the stick nearest to it there is sent.
  glm::dvec3 when_imaged(const glm::dvec3& rest_m) const {
    constexpr int kRounds = 8;
    hw::StickIndex stick{volume_, 0, 0};
    glm::dvec3 at{0};
    for (int round = 0; round < kRounds; ++round) {
      at = subject_.from_rest(rest_m, time_s(stick));
      const hw::StickIndex next = surfaces_.stick_at(at);
      if (next == stick) break;
      stick = next;
    }
    return at;
  }

  /// Nothing lies before it on the picture's ray through it, its pixel shows the skin about it, and
  /// it has the depth of that pixel or lies between it and the next. At a rim the pixel may show
  /// nothing, or what is far behind.
  bool is_in_picture(const render::PicturePoint& at) const {
    const int size = camera_.image_size;
    if (column(at) < 0 || row(at) < 0 || column(at) >= size || row(at) >= size) return false;
    const hw::Ray ray = camera_.ray(at.column, at.row);
    const render::Span span = render::clip_to_box(ray, box_);
    if (at.depth_m < span.from_m || at.depth_m > span.to_m) return false;
    const auto first = surfaces_.first(ray);
    if (first && first->distance_m < at.depth_m - kOwnPoint_m) return false;
    const auto shown_m = static_cast<double>(truth_.any_depth_m(column(at), row(at)));
    if (!(std::abs(shown_m - at.depth_m) < kOwnSkin_m)) return false;
    double near_m = std::numeric_limits<double>::infinity(), far_m = -near_m;
    for (int r = std::max(row(at) - 1, 0); r <= std::min(row(at) + 1, size - 1); ++r) {
      for (int c = std::max(column(at) - 1, 0); c <= std::min(column(at) + 1, size - 1); ++c) {
        const auto depth_m = static_cast<double>(truth_.any_depth_m(c, r));
        near_m = std::min(near_m, depth_m);  // NaN: stays
        far_m = std::max(far_m, depth_m);
      }
    }
    return at.depth_m > near_m - kOwnPoint_m && at.depth_m < far_m + kOwnPoint_m;
  }

  TruthKind kind_of(const glm::dvec3& position_m) const {
    const hw::PolarPoint polar = geometry_.to_polar(position_m);
    if (!in_field(plan_, polar)) return TruthKind::outside_field;
    const hw::StickIndex stick = surfaces_.stick_at(position_m);
    const auto skin = surfaces_.distance(position_m, stick);
    const glm::dvec3 along =
        geometry_.stick(plan_.theta_rad(static_cast<int>(stick.line)), plan_.motor_angle_rad(stick))
            .direction;
    if (!skin || -glm::dot(along, glm::normalize(skin->gradient)) < std::cos(kGrazing_rad)) {
      return TruthKind::grazing;
    }
    return polar.range_m > reach_.at(position_m) ? TruthKind::shadowed : TruthKind::surface;
  }

  const phantoms::PlacedPhantom subject_;
  const hw::AcquisitionPlan& plan_;
  hw::ProbeGeometry geometry_;
  render::Camera camera_;
  render::VolumeOfInterest box_;
  const Truth& truth_;
  const StickReach& reach_;
  SightLines sight_;
  ScannedSurfaces surfaces_;
  std::uint32_t volume_;
};

Image<std::uint8_t> parts_before(const ResolvedScene& scene,
                                 const Truth& truth,
                                 std::uint32_t volume) {
  const render::View view = scene.view();
  tbb::enumerable_thread_specific<SightLines> of_threads(
      scene.subject().value(), scene.plan(), view, volume);
  Image<std::uint8_t> before(truth.kind.width, truth.kind.height, 0);
  tbb::parallel_for(
      tbb::blocked_range<int>(0, before.height), [&](const tbb::blocked_range<int>& rows) {
        const SightLines& sight = of_threads.local();
        for (int row = rows.begin(); row < rows.end(); ++row) {
          for (int column = 0; column < before.width; ++column) {
            if (truth.kind.at(column, row) == TruthKind::none) continue;
            const auto depth_m = static_cast<double>(truth.any_depth_m(column, row));
            before.at(column, row) = sight.before(view.camera.ray(column, row).at(depth_m));
          }
        }
      });
  return before;
}

}  // namespace

Labels label_truth(const ResolvedScene& scene,
                   const Truth& truth,
                   const StickReach& reach,
                   std::uint32_t volume) {
  const phantoms::Phantom& phantom = scene.subject().value().phantom;
  Labels labels{.before = parts_before(scene, truth, volume), .names = {}, .landmarks = {}};
  std::vector<std::uint8_t> used = truth.part.pixels;
  used.insert(used.end(), labels.before.pixels.begin(), labels.before.pixels.end());
  const LandmarkFinder finder(scene, truth, reach, volume);
  for (const phantoms::Landmark& landmark : phantom.landmarks()) {
    labels.landmarks.push_back(finder.find(landmark));
    used.push_back(labels.landmarks.back().before);
  }
  labels.names = labels_in(used, phantom);
  return labels;
}

}  // namespace wobblebench::bench
