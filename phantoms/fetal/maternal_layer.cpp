#include "phantoms/fetal/maternal_layer.h"
#include "base/units.h"

#include <algorithm>
#include <cmath>

namespace wobblebench::phantoms {
namespace {

// Radius of the default probe's face: the interfaces are centred where its sticks come from.
constexpr double kFaceRadius_m = 40 * kMillimetre;

// The bodies are cut off this far behind the foremost point of the face, where its rim has curved
// out of the tissue.
constexpr double kRim_m = 16 * kMillimetre;

// Slow waves of up to 2 times 1, on a plane.
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
  // Waves of up to 0.5 mm about the mean: slopes up to 0.16.
  return {{face_m_ - glm::dvec3(0, 0, kFaceRadius_m), {across, across, along}},
          std::min(0.02 * depth_m, 0.5 * kMillimetre),
          phase,
          waves(phase, 0, 0)};
}

double MaternalLayer::distance(const Interface& interface, const glm::dvec3& p) const {
  const glm::dvec3 arm = p - face_m_;
  const double uneven =
      interface.unevenness_m * (waves(interface.phase, arm.x, arm.y) - interface.wave_on_axis);
  return std::max(interface.mean.distance(p) - uneven, -kRim_m - arm.z);
}

Box MaternalLayer::bounds() const {
  const glm::dvec3 half = muscle_.mean.radii_m + 5 * kMillimetre;
  return {face_m_ - glm::dvec3(half.x, half.y, kRim_m + 5 * kMillimetre),
          face_m_ + glm::dvec3(half.x, half.y, half.z - kFaceRadius_m)};
}

}  // namespace wobblebench::phantoms
