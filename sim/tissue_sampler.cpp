#include "sim/tissue_sampler.h"

#include <openvdb/tools/Interpolation.h>

#include <cmath>
#include <glm/geometric.hpp>

#include "phantoms/grids.h"

namespace wobblebench::sim {

namespace {

/// One surface's signed distance along rays, with the accessor that caches the tree's path.
class SurfaceProbe {
 public:
  SurfaceProbe(const openvdb::FloatGrid& grid, phantoms::MaterialIndex inside)
      : grid_(&grid), accessor_(grid.getConstAccessor()), inside_(inside) {}

  double distance(const glm::dvec3& p) const {
    const openvdb::Vec3d index = grid_->transform().worldToIndex({p.x, p.y, p.z});
    return openvdb::tools::BoxSampler::sample(accessor_, index);
  }

  glm::dvec3 normal(const glm::dvec3& p) const {
    const double h = grid_->voxelSize()[0];
    glm::dvec3 gradient;
    for (int axis = 0; axis < 3; ++axis) {
      glm::dvec3 step(0);
      step[axis] = h;
      gradient[axis] = distance(p + step) - distance(p - step);
    }
    const double length = glm::length(gradient);
    return length > 0 ? gradient / length : glm::dvec3(0, 0, 1);
  }

  phantoms::MaterialIndex inside() const { return inside_; }

 private:
  const openvdb::FloatGrid* grid_;
  openvdb::FloatGrid::ConstAccessor accessor_;
  phantoms::MaterialIndex inside_;
};

/// Interpolated distances may overstate the way to the surface by a few percent; a leap stays short
/// of it by this much.
constexpr double kLeapSafety = 0.8;

}  // namespace

struct TissueSampler::State {
  phantoms::Phantom phantom;  // keeps the grids alive
  phantoms::Placement placement;
  std::vector<SurfaceProbe> surfaces;

  /// What lies at a point, and how far the nearest surface is at least.
  struct Sample {
    phantoms::MaterialIndex material;
    double clearance_m;
    std::vector<double> distances;
  };

  void sample(const glm::dvec3& p, Sample& out) const {
    out.material = phantom.background();
    out.clearance_m = surfaces.empty() ? 1.0 : HUGE_VAL;
    for (std::size_t i = 0; i < surfaces.size(); ++i) {
      const double d = surfaces[i].distance(p);
      out.distances[i] = d;
      out.clearance_m = std::min(out.clearance_m, std::abs(d));
      if (d < 0) out.material = surfaces[i].inside();
    }
  }

  /// The interface between two neighbouring samples of different material: the crossing, among
  /// those between them, of the surface that is met first.
  Interface crossing(
      const hw::Ray& ray, double from_m, const Sample& a, double to_m, const Sample& b) const {
    Interface result{to_m, a.material, b.material, 1.0};
    double nearest = HUGE_VAL;
    for (std::size_t i = 0; i < surfaces.size(); ++i) {
      const double da = a.distances[i], db = b.distances[i];
      if ((da < 0) == (db < 0)) continue;
      const double at = from_m + (to_m - from_m) * da / (da - db);
      if (at >= nearest) continue;
      nearest = at;
      result.range_m = at;
      result.cos_incidence = std::abs(glm::dot(surfaces[i].normal(ray.at(at)), ray.direction));
    }
    return result;
  }
};

TissueSampler::TissueSampler(const phantoms::Phantom& phantom, const phantoms::Placement& placement)
    : state_(new State{phantom, placement, {}}) {
  const auto& grids = state_->phantom.grids().signed_distance;
  for (std::size_t i = 0; i < grids.size(); ++i) {
    state_->surfaces.emplace_back(*grids[i], phantom.surfaces()[i].inside);
  }
}

TissueSampler::TissueSampler(TissueSampler&&) noexcept = default;
TissueSampler::~TissueSampler() = default;

TissueProfile TissueSampler::profile(const hw::Ray& stick, double spacing_m, int count) {
  const hw::Ray ray{state_->placement.to_phantom(stick.origin),
                    state_->placement.direction_to_phantom(stick.direction)};
  const auto range = [&](int i) { return (i + 0.5) * spacing_m; };

  State::Sample current{0, 0, std::vector<double>(state_->surfaces.size())};
  State::Sample previous = current;
  state_->sample(ray.at(range(0)), current);

  TissueProfile profile;
  profile.stretches.push_back({0, count, current.material});
  for (int i = 0; i < count;) {
    // No surface is nearer than the clearance, so the material cannot change within the leap.
    const int leap = std::max(1, static_cast<int>(kLeapSafety * current.clearance_m / spacing_m));
    const int next = i + leap;
    if (next >= count) break;
    std::swap(previous, current);
    state_->sample(ray.at(range(next)), current);
    if (current.material != previous.material) {
      profile.interfaces.push_back(state_->crossing(ray, range(i), previous, range(next), current));
      profile.stretches.back().last = next;
      profile.stretches.push_back({next, count, current.material});
    }
    i = next;
  }
  return profile;
}

}  // namespace wobblebench::sim
