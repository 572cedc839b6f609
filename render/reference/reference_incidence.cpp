// The correction for the beam's width in the reference, between passes 2 and 3.
#include <cmath>
#include <glm/geometric.hpp>

#include "base/parallel.h"
#include "render/passes/incidence_correction.h"
#include "render/reference/reference_passes.h"

namespace wobblebench::render::reference {
namespace {

/// A point of the filtered surface.
class Surface {
 public:
  Surface(const Image<double>& depth_m, const Camera& camera)
      : depth_m_(depth_m), camera_(camera) {}

  bool has(int column, int row) const {
    return column >= 0 && row >= 0 && column < depth_m_.width && row < depth_m_.height &&
           !std::isnan(depth_m_.at(column, row));
  }
  glm::dvec3 point(int column, int row) const {
    return camera_.ray(column, row).at(depth_m_.at(column, row));
  }
  /// Between the neighbours on both sides, as far as they exist.
  glm::dvec3 tangent(int column, int row, int right, int down) const {
    const auto end = [&](int side) {
      const int c = column + side * right, r = row + side * down;
      return has(c, r) ? point(c, r) : point(column, row);
    };
    return end(1) - end(-1);
  }

 private:
  const Image<double>& depth_m_;
  const Camera& camera_;
};

glm::dvec3 stick_direction(const hw::ProbeGeometry& geometry, const glm::dvec3& position_m) {
  const hw::PolarPoint polar = geometry.to_polar(position_m);
  return geometry.stick(polar.theta_rad, polar.phi_rad).direction;
}

}  // namespace

Image<double> correct_incidence(const Image<double>& depth_m,
                                const hw::ProbeGeometry& geometry,
                                const RenderOptions& options) {
  const double correction_m = options.ray_casting.incidence_correction_m;
  if (correction_m == 0 || options.ray_casting.mode == RenderMode::volume) return depth_m;
  const Camera camera = make_camera(options);
  const Image<double> filtered = filter_depth(depth_m, normal_window(options));
  const Surface surface(filtered, camera);
  Image<double> corrected = depth_m;
  parallel_rows(depth_m.height, [&](int row) {
    for (int column = 0; column < depth_m.width; ++column) {
      if (!surface.has(column, row)) continue;
      const glm::dvec3 across =
          glm::cross(surface.tangent(column, row, 1, 0), surface.tangent(column, row, 0, 1));
      if (glm::length(across) == 0) continue;
      const glm::dvec3 normal = glm::normalize(across);
      const hw::Ray ray = camera.ray(column, row);
      const glm::dvec3 stick = stick_direction(geometry, ray.at(depth_m.at(column, row)));
      const double sine = glm::length(glm::cross(normal, stick));
      const double cosine = std::abs(glm::dot(normal, ray.direction));
      corrected.at(column, row) += correction_m * std::min(sine / cosine, kMaxTangent);
    }
  });
  return corrected;
}

}  // namespace wobblebench::render::reference
