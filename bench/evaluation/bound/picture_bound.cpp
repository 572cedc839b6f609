#include "bench/evaluation/bound/picture_bound.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <optional>
#include <vector>

#include "base/parallel.h"
#include "base/units.h"
#include "bench/evaluation/truth/truth.h"
#include "sim/optics/beam_profile.h"

namespace wobblebench::bench {

namespace {

constexpr double kRiseStep = 0.05;  ///< of its logarithm
constexpr double kEchoStep_db = 1;
constexpr double kDensityStep = 0.1;

/// Below two sticks a width a stick has no neighbour in its beam.
int density_steps(double fwhm_m, double spacing_m) {
  const double density = fwhm_m / spacing_m;
  return density < 2 ? 0 : static_cast<int>(std::lround(density / kDensityStep));
}

double spacing_m(double fwhm_m, int steps) {
  return steps == 0 ? fwhm_m : fwhm_m / (steps * kDensityStep);
}

struct Pixel {
  int column;
  int row;
  BoundTable::Entry entry;
  double along_ray;  ///< error along the ray for one along the stick
};

/// Conditions at any point of the scan.
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

BoundTable::Entry BoundTable::add(const DetectionConditions& c) {
  const double widening = rise_sigma_m(c) / sim::power_sigma(like_.pulse_fwhm_m);
  const Key key{static_cast<int>(std::lround(std::log(widening) / kRiseStep)),
                static_cast<int>(std::lround(c.tissue_db / kEchoStep_db)),
                density_steps(c.lateral_fwhm_m, c.line_spacing_m),
                density_steps(c.elevation_fwhm_m, c.frame_spacing_m)};
  const auto [at, is_new] = entries_.try_emplace(key, keys_.size());
  if (is_new) keys_.push_back(key);
  return at->second;
}

/// A slope in the image plane that gives the rise of the key.
DetectionConditions BoundTable::conditions_of(const Key& key) const {
  DetectionConditions c = like_;
  const double widening = std::exp(key[0] * kRiseStep);
  const double pulse_m = sim::power_sigma(like_.pulse_fwhm_m);
  const double footprint_m = pulse_m * std::sqrt(std::max(0.0, widening * widening - 1));
  // The width of the beam keeps the incidence at 45 degrees.
  c.incidence_rad = footprint_m > 0 ? 45 * kDegree : 0;
  c.azimuth_rad = 0;
  if (footprint_m > 0) c.lateral_fwhm_m *= footprint_m / sim::power_sigma(c.lateral_fwhm_m);
  c.tissue_db = key[1] * kEchoStep_db;
  c.line_spacing_m = spacing_m(c.lateral_fwhm_m, key[2]);
  c.frame_spacing_m = spacing_m(c.elevation_fwhm_m, key[3]);
  return c;
}

void BoundTable::compute() {
  for (const Key& key : keys_) validate(conditions_of(key));
  bounds_.resize(keys_.size());
  parallel_rows(static_cast<int>(keys_.size()), [&](int i) {
    const auto at = static_cast<std::size_t>(i);
    bounds_[at] = detection_bound_m(conditions_of(keys_[at]));
  });
}

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
