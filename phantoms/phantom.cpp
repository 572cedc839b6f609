#include "phantoms/phantom.h"

#include <glm/matrix.hpp>
#include <glm/trigonometric.hpp>
#include <stdexcept>
#include <utility>

#include "phantoms/grids.h"
#include "phantoms/label_finder.h"

namespace wobblebench::phantoms {

Phantom::Phantom(std::string name,
                 std::vector<Material> materials,
                 MaterialIndex background,
                 std::vector<Surface> surfaces,
                 Box region_of_interest,
                 glm::dvec3 suggested_position_m,
                 std::shared_ptr<const Grids> grids,
                 std::optional<Joint> joint,
                 PointScatterers scatterers)
    : name_(std::move(name)),
      materials_(std::move(materials)),
      background_(background),
      surfaces_(std::move(surfaces)),
      region_of_interest_(region_of_interest),
      suggested_position_m_(suggested_position_m),
      grids_(std::move(grids)),
      joint_(joint),
      scatterers_(std::make_shared<const PointScatterers>(std::move(scatterers))) {
  if (grids_ == nullptr || grids_->signed_distance.size() != surfaces_.size()) {
    throw std::logic_error("phantom " + name_ + ": needs one grid for each surface");
  }
}

Phantom Phantom::with(const PointScatterers& more) const {
  auto all = std::make_shared<PointScatterers>(*scatterers_);
  all->add(more);
  Phantom phantom(*this);
  phantom.scatterers_ = std::move(all);
  return phantom;
}

Phantom Phantom::with_parts(PhantomParts parts, std::vector<Landmark> landmarks) const {
  if (parts.surfaces.size() != surfaces_.size()) {
    throw std::logic_error("phantom " + name_ + ": needs parts for each surface");
  }
  Phantom phantom(*this);
  phantom.parts_ = std::make_shared<const PhantomParts>(std::move(parts));
  phantom.landmarks_ = std::move(landmarks);
  return phantom;
}

Phantom Phantom::with_measures(std::vector<PhantomMeasure> measures) const {
  Phantom phantom(*this);
  phantom.measures_ = std::move(measures);
  return phantom;
}

glm::dvec3 Placement::to_phantom(const glm::dvec3& probe_m) const {
  return glm::transpose(rotation) * (probe_m - position_m);
}

glm::dvec3 Placement::direction_to_phantom(const glm::dvec3& direction) const {
  return glm::transpose(rotation) * direction;
}

glm::dvec3 Placement::direction_to_probe(const glm::dvec3& direction) const {
  return rotation * direction;
}

glm::dmat3 rotation_xyz(const glm::dvec3& angles_rad) {
  const glm::dvec3 c = glm::cos(angles_rad), s = glm::sin(angles_rad);
  // glm matrices are given column by column.
  const glm::dmat3 about_x(1, 0, 0, 0, c.x, s.x, 0, -s.x, c.x);
  const glm::dmat3 about_y(c.y, 0, -s.y, 0, 1, 0, s.y, 0, c.y);
  const glm::dmat3 about_z(c.z, s.z, 0, -s.z, c.z, 0, 0, 0, 1);
  return about_z * about_y * about_x;
}

}  // namespace wobblebench::phantoms
