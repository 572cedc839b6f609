#include "phantoms/fetal/maternal_layer.h"
#include "base/units.h"

#include <algorithm>
#include <cmath>

namespace wobblebench::phantoms {
namespace {

// Radius of the default probe's face: the interfaces are centred on the origin of its sticks.
constexpr double kFaceRadius_m = 40 * kMillimetre;

// The bodies end this far behind the foremost point of the face, where its curved rim has left the
// tissue.
constexpr double kRim_m = 16 * kMillimetre;

// Sum of two plane waves of unit amplitude, wavelength about 40 mm.
double waves(double phase, double x, double y) {
  constexpr double k = 2 * kPi / (40 * kMillimetre);
  return std::sin(k * x + 0.6 * k * y + phase) + std::sin(0.7 * k * y - 0.4 * k * x + 2 * phase);
}

}  // namespace

MaternalDepths maternal_depths(double thickness_m) {
  const double skin = std::min(2 * kMillimetre, thickness_m / 5);
  return {skin, skin + 0.6 * (thickness_m - skin), thickness_m};
}

MaternalLayer::MaternalLayer(double thickness_m, const glm::dvec3& face_m) : face_m_(face_m) {
  const MaternalDepths depths = maternal_depths(thickness_m);
  skin_ = interface(depths.skin_m);
  fat_ = interface(depths.fat_m);
  muscle_ = interface(depths.muscle_m);
}

MaternalLayer::Interface MaternalLayer::interface(double depth_m) const {
  const double along = kFaceRadius_m + depth_m;
  const double curvature_radius = kFaceRadius_m + 4 * depth_m;
  const double across = std::sqrt(curvature_radius * along);
  const double phase = depth_m / (6 * kMillimetre);
  // Undulation of at most 0.5 mm times waves(): slopes up to 0.16.
  return {{face_m_ - glm::dvec3(0, 0, kFaceRadius_m), {across, across, along}},
          std::min(0.02 * depth_m, 0.5 * kMillimetre),
          phase,
          waves(phase, 0, 0)};
}

double MaternalLayer::distance(const Interface& interface, const glm::dvec3& p) const {
  const glm::dvec3 arm = p - face_m_;
  const double offset =
      interface.undulation_m * (waves(interface.phase, arm.x, arm.y) - interface.wave_at_axis);
  return std::max(interface.mean.distance(p) - offset, -kRim_m - arm.z);
}

Box MaternalLayer::bounds() const {
  const glm::dvec3 half = muscle_.mean.radii_m + 5 * kMillimetre;
  return {face_m_ - glm::dvec3(half.x, half.y, kRim_m + 5 * kMillimetre),
          face_m_ + glm::dvec3(half.x, half.y, half.z - kFaceRadius_m)};
}

}  // namespace wobblebench::phantoms
