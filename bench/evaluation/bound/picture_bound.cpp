#include "bench/evaluation/bound/picture_bound.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <optional>
#include <vector>

#include "base/units.h"
#include "bench/evaluation/bound/bound_table.h"
#include "bench/evaluation/truth/pixel_area.h"

namespace wobblebench::bench {

namespace {

struct Pixel {
  int column;
  int row;
  BoundTable::Entry entry;
  double along_ray;  ///< error along the ray for one along the stick
};

/// The motor and stick angles that a point would be imaged at, with its range.
struct Scanned {
  const hw::AcquisitionPlan& plan;
  const sim::BeamProfile profile;
  const sim::SimulationOptions& simulation;
  double tissue_mean_db;

  DetectionConditions at(const glm::dvec3& position, const glm::dvec3& normal) const {
    return conditions_at(
        plan, profile, simulation, plan.geometry().to_polar(position), normal, tissue_mean_db);
  }
};

bool is_grazing(const DetectionConditions& conditions) {
  return conditions.incidence_rad > kMostIncidence_rad - 1e-6;
}

/// Both errors are the same displacement of the surface along its normal.
double along_ray(const DetectionConditions& conditions,
                 const glm::dvec3& direction,
                 const glm::dvec3& normal) {
  return std::cos(conditions.incidence_rad) /
         std::max(std::abs(glm::dot(direction, normal)), kLeastCosine);
}

}  // namespace

PictureBound picture_bound(const Truth& truth,
                           const render::Camera& camera,
                           const hw::AcquisitionPlan& plan,
                           const sim::SimulationOptions& simulation,
                           double tissue_mean_db,
                           const CountedPixel& counted) {
  const int width = truth.kind.width, height = truth.kind.height;
  PictureBound result{.map_m = {width, height, kNoSurface}};
  const Scanned scanned{
      plan, sim::BeamProfile(sim::ProbeOptics(plan, simulation)), simulation, tissue_mean_db};
  std::optional<BoundTable> table;
  std::vector<Pixel> pixels;
  for (int row = 0; row < height; ++row) {
    for (int column = 0; column < width; ++column) {
      if (truth.kind.at(column, row) != TruthKind::surface || !counted(column, row)) continue;
      const hw::Ray ray = camera.ray(column, row);
      const glm::dvec3 normal(truth.normal.at(column, row));
      const auto conditions =
          scanned.at(ray.at(static_cast<double>(truth.depth_m.at(column, row))), normal);
      if (is_grazing(conditions)) {
        ++result.grazing;
        continue;
      }
      if (!table) table.emplace(conditions);
      pixels.push_back(
          {column, row, table->add(conditions), along_ray(conditions, ray.direction, normal)});
    }
  }
  if (table) table->compute();
  double squares = 0;
  for (const Pixel& pixel : pixels) {
    const double bound_m = table->bound_m(pixel.entry) * pixel.along_ray;
    result.map_m.at(pixel.column, pixel.row) = static_cast<float>(bound_m);
    squares += bound_m * bound_m;
  }
  result.n = static_cast<int>(pixels.size());
  result.rms_m =
      result.n > 0 ? std::sqrt(squares / result.n) : std::numeric_limits<double>::quiet_NaN();
  result.between_sticks_m = kBetweenSticks * result.rms_m;
  return result;
}

}  // namespace wobblebench::bench
