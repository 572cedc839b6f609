// The exact surface that a ray meets.
#pragma once

#include <glm/vec3.hpp>
#include <memory>
#include <optional>
#include <vector>

#include "phantoms/phantom.h"

namespace wobblebench::phantoms {

struct SurfaceHit {
  double distance_m = 0;  ///< along the ray from its origin
  glm::dvec3 normal{0};   ///< unit, from the signed distance, pointing towards its positive side
  int surface = 0;        ///< index into Phantom::surfaces()
};

/// First crossings of the target surfaces, by OpenVDB's level-set ray intersector. Phantom frame.
/// Const functions may be called from several threads, each thread with its own SurfaceFinder copy.
class SurfaceFinder {
 public:
  /// `reach_m`: distance() knows points at least this near a target surface; the narrow bands are
  /// widened (by fast sweeping, in memory) where they are narrower. `within`: only points in this
  /// box will be asked about, so that only what lies within reach of it is widened.
  explicit SurfaceFinder(const Phantom& phantom,
                         double reach_m = 0,
                         const std::optional<Box>& within = {});
  SurfaceFinder(const SurfaceFinder& other);
  ~SurfaceFinder();

  /// First crossing of any target surface between the two distances along a unit direction.
  std::optional<SurfaceHit> first_hit(const glm::dvec3& origin,
                                      const glm::dvec3& direction,
                                      double from_m,
                                      double to_m) const;

  /// Signed distance to the nearest target surface (negative in tissue) and its gradient, for
  /// points within the bands; nullopt beyond them.
  struct Distance {
    double value_m;
    glm::dvec3 gradient;
  };
  std::optional<Distance> distance(const glm::dvec3& position) const;

  /// The target surfaces one by one, for who goes along a line that a moving phantom bends.
  int targets() const;
  /// Index into Phantom::surfaces() of a target, 0 to targets() - 1.
  int surface(int target) const;
  /// Distance to this one surface as distance() gives it; nullopt beyond its band.
  std::optional<Distance> target_distance(int target, const glm::dvec3& position) const;
  /// Its value alone. Beyond the band: negative inside, and of a size that the true distance is
  /// sure to exceed.
  double cautious_distance(int target, const glm::dvec3& position) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace wobblebench::phantoms
