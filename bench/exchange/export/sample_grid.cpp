#include "bench/exchange/export/sample_grid.h"

#include <glm/common.hpp>

namespace wobblebench::bench {

namespace {

/// Middle and ends of an interval: the extremes of the scan's corners lie there.
std::vector<double> ends(double half) {
  return {-half, 0, half};
}

}  // namespace

SampleGrid grid_around(const hw::AcquisitionPlan& plan, double spacing_m) {
  const hw::ProbeGeometry geometry = plan.geometry();
  const hw::AcquisitionOptions& scan = plan.acquisition();
  glm::dvec3 low(std::numeric_limits<double>::infinity()), high(-low);
  for (const double range_m : {0.0, scan.depth_m}) {
    for (const double theta_rad : ends(0.5 * scan.sector_rad)) {
      for (const double phi_rad : ends(0.5 * scan.fan_rad)) {
        const glm::dvec3 point = geometry.to_cartesian({range_m, theta_rad, phi_rad});
        low = glm::min(low, point);
        high = glm::max(high, point);
      }
    }
  }
  const glm::dvec3 first = glm::floor(low / spacing_m), last = glm::ceil(high / spacing_m);
  return {spacing_m * first, spacing_m, glm::ivec3(last - first) + 1};
}

}  // namespace wobblebench::bench
