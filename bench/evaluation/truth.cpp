#include "bench/evaluation/truth.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <cmath>

#include "bench/evaluation/scanned_surfaces.h"

namespace wobblebench::bench {

namespace {

bool in_field(const hw::AcquisitionPlan& plan, const glm::dvec3& position) {
  const hw::PolarPoint p = plan.geometry().to_polar(position);
  const auto& a = plan.acquisition();
  return p.range_m >= 0 && p.range_m <= a.depth_m && std::abs(p.theta_rad) <= a.sector_rad / 2 &&
         std::abs(p.phi_rad) <= a.fan_rad / 2;
}

}  // namespace

Truth trace_truth(const phantoms::PlacedPhantom& subject,
                  const hw::AcquisitionPlan& plan,
                  const render::View& view,
                  std::uint32_t volume) {
  const int size = view.camera.image_size;
  Truth truth{{size, size, kNoSurface}, {size, size}, {size, size, TruthKind::none}};
  const ScannedSurfaces shared(subject, plan, view, 0, volume);
  tbb::parallel_for(tbb::blocked_range<int>(0, size), [&](const tbb::blocked_range<int>& rows) {
    // One copy for each range of rows: its OpenVDB accessors must not be shared between threads.
    // NOLINTNEXTLINE(performance-unnecessary-copy-initialization)
    const ScannedSurfaces surfaces(shared);
    for (int row = rows.begin(); row < rows.end(); ++row) {
      for (int column = 0; column < size; ++column) {
        const hw::Ray ray = view.camera.ray(column, row);
        const auto hit = surfaces.first(ray);
        if (!hit) continue;
        const bool visible = in_field(plan, ray.at(hit->distance_m));
        truth.kind.at(column, row) = visible ? TruthKind::surface : TruthKind::outside_field;
        if (!visible) continue;
        truth.depth_m.at(column, row) = static_cast<float>(hit->distance_m);
        truth.normal.at(column, row) = hit->outward;
      }
    }
  });
  return truth;
}

}  // namespace wobblebench::bench
