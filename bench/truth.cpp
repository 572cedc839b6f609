#include "bench/truth.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <cmath>
#include <glm/geometric.hpp>

#include "phantoms/truth.h"
#include "render/camera.h"

namespace wobblebench::bench {

namespace {

/// A material that echoes is tissue; one that does not is fluid.
constexpr double kTissueBackscatterDb = -100;
/// Past a crossing of the wrong sign the search goes on this far behind it.
constexpr double kPastCrossing_m = 1e-5;

bool is_tissue(const phantoms::Phantom& phantom, int surface) {
  const auto inside = phantom.surfaces().at(static_cast<std::size_t>(surface)).inside;
  return phantom.materials().at(static_cast<std::size_t>(inside)).backscatter_db >
         kTissueBackscatterDb;
}

struct Hit {
  double distance_m;
  glm::dvec3 outward;  ///< out of the tissue, phantom frame
};

std::optional<Hit> first_of_sign(const phantoms::SurfaceFinder& finder,
                                 const phantoms::Phantom& phantom,
                                 const hw::Ray& ray,
                                 render::Span span,
                                 render::EdgeSign sign) {
  while (span.from_m < span.to_m) {
    const auto hit = finder.first_hit(ray.origin, ray.direction, span.from_m, span.to_m);
    if (!hit) return std::nullopt;
    const glm::dvec3 outward = is_tissue(phantom, hit->surface) ? hit->normal : -hit->normal;
    const bool enters_tissue = glm::dot(outward, ray.direction) < 0;
    if (enters_tissue == (sign == render::EdgeSign::rising)) return Hit{hit->distance_m, outward};
    span.from_m = hit->distance_m + kPastCrossing_m;
  }
  return std::nullopt;
}

bool in_field(const hw::AcquisitionPlan& plan, const glm::dvec3& position) {
  const hw::PolarPoint p = plan.geometry().to_polar(position);
  const auto& a = plan.acquisition();
  return p.range_m >= 0 && p.range_m <= a.depth_m && std::abs(p.theta_rad) <= a.sector_rad / 2 &&
         std::abs(p.phi_rad) <= a.fan_rad / 2;
}

}  // namespace

Truth trace_truth(const phantoms::Phantom& phantom,
                  const phantoms::Placement& placement,
                  const hw::AcquisitionPlan& plan,
                  const render::RenderOptions& options) {
  const render::Camera camera = render::make_camera(options);
  const int size = camera.image_size;
  Truth truth{{size, size, render::kNoSurface}, {size, size}, {size, size, TruthKind::none}};
  const phantoms::SurfaceFinder shared(phantom);
  tbb::parallel_for(tbb::blocked_range<int>(0, size), [&](const tbb::blocked_range<int>& rows) {
    // A copy for each range: it carries accessors that threads must not share.
    // NOLINTNEXTLINE(performance-unnecessary-copy-initialization)
    const phantoms::SurfaceFinder finder(shared);
    for (int row = rows.begin(); row < rows.end(); ++row) {
      for (int column = 0; column < size; ++column) {
        const hw::Ray ray = camera.ray(column, row);
        const auto span = render::clip_to_box(ray, options.volume_of_interest);
        const hw::Ray local{placement.to_phantom(ray.origin),
                            placement.direction_to_phantom(ray.direction)};
        const auto hit = first_of_sign(finder, phantom, local, span, options.ray_casting.edge);
        if (!hit) continue;
        const bool seen = in_field(plan, ray.at(hit->distance_m));
        truth.kind.at(column, row) = seen ? TruthKind::surface : TruthKind::outside_field;
        if (!seen) continue;
        truth.depth_m.at(column, row) = static_cast<float>(hit->distance_m);
        truth.normal.at(column, row) = placement.direction_to_probe(hit->outward);
      }
    }
  });
  return truth;
}

}  // namespace wobblebench::bench
