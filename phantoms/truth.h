// Ray casting and signed distances on the target surfaces of a phantom: the ground truth.
#pragma once

#include <glm/vec3.hpp>
#include <memory>
#include <optional>
#include <vector>

#include "phantoms/phantom.h"

namespace wobblebench::phantoms {

struct SurfaceHit {
  double distance_m = 0;  ///< along the ray from its origin
  glm::dvec3 normal{0};   ///< unit; gradient of the signed distance, towards its positive side
  int surface = 0;        ///< index into Phantom::surfaces()
};

/// First crossings of the target surfaces, by OpenVDB's level-set ray intersector, and distances to
/// them. Phantom frame, metres. Not thread-safe, not even its const functions: one copy per thread.
///
/// @code
/// #include <iostream>
/// const phantoms::Phantom sphere = phantoms::make_phantom({.name = "sphere", .radius_m = 20e-3});
/// const phantoms::SurfaceFinder finder(sphere);
/// const glm::dvec3 origin(0, 0, -0.1), direction(0, 0, 1);
/// const auto hit = finder.first_hit(origin, direction, 0, 0.2);
/// if (hit) std::cout << hit->distance_m << " m, surface " << hit->surface;  // 0.08 m, surface 0
/// @endcode
class SurfaceFinder {
 public:
  /// `reach_m`: distance() is defined at least this near a target surface; narrower bands are
  /// widened by fast sweeping, in memory. `within`: distance() will be called for points in this
  /// box only, so that bands are widened within reach of the box only.
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

  /// Signed distance to the nearest target surface (negative inside it) and its gradient; nullopt
  /// outside the narrow bands.
  struct Distance {
    double value_m;
    glm::dvec3 gradient;
  };
  std::optional<Distance> distance(const glm::dvec3& position) const;

  /// The target surfaces one by one, for rays that a moving phantom bends.
  int targets() const;
  /// Index into Phantom::surfaces() of a target, 0 to targets() - 1.
  int surface(int target) const;
  /// As distance(), to this one surface.
  std::optional<Distance> target_distance(int target, const glm::dvec3& position) const;
  /// The value of target_distance(); outside the band a lower bound of it, with its sign, for
  /// sphere tracing.
  double distance_bound(int target, const glm::dvec3& position) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace wobblebench::phantoms
