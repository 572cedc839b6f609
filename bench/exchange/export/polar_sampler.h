// Samples of a polar volume at any position.
#pragma once

#include <glm/vec3.hpp>
#include <optional>
#include <utility>
#include <vector>

#include "hw/probe/polar_volume.h"

namespace wobblebench::bench {

/// Trilinear between neighbours in range, stick angle and motor angle. Frames lie at the motor
/// angles that their sticks tell, in whichever order they were acquired.
class PolarSampler {
 public:
  /// `volume` must outlive it.
  explicit PolarSampler(const hw::PolarVolume& volume);

  /// nullopt: outside sector, fan or depth.
  std::optional<double> at(const glm::dvec3& position_m) const;
  std::optional<double> at(const hw::PolarPoint& point) const;
  /// In one frame, at a distance and an angle from its centre of curvature.
  std::optional<double> in_frame(int frame, double radius_m, double theta_rad) const;

 private:
  /// Two neighbours, and the share of the second.
  struct Between {
    int first = 0;
    int second = 0;
    double share = 0;
  };
  std::optional<Between> samples(double range_m) const;
  std::optional<Between> lines(double theta_rad) const;
  std::optional<Between> frames(int line, double phi_rad) const;
  double in_stick(int frame, int line, const Between& samples) const;

  const hw::PolarVolume& volume_;
  hw::ProbeGeometry geometry_;
  /// [line]: motor angle and frame, by growing angle.
  std::vector<std::vector<std::pair<double, int>>> angles_;
};

}  // namespace wobblebench::bench
