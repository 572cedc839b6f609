// Phantoms: closed surfaces as OpenVDB level sets, the materials that they enclose, and point
// scatterers. This header does not include OpenVDB; phantoms/grids.h gives access to the grids.
//
// Phantom frame (docs/units.md): metres, right-handed, axes parallel to those of the probe frame at
// rest: x to the right of the picture, y down the picture, z away from the probe. The origin is the
// phantom's own centre; `Placement` transforms to the probe frame.
#pragma once

#include <filesystem>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "phantoms/material.h"
#include "phantoms/motion.h"
#include "phantoms/options.h"
#include "phantoms/point_scatterers.h"

namespace wobblebench::phantoms {

struct Grids;         // phantoms/grids.h
struct PhantomParts;  // phantoms/label_finder.h

/// An axis-aligned box.
struct Box {
  glm::dvec3 low{0};
  glm::dvec3 high{0};
};

/// One closed surface. Where surfaces overlap, the material of the last one applies.
struct Surface {
  std::string name;
  MaterialIndex inside = 0;  ///< material within the surface
  /// Whether the renderer is to detect this surface: fluid on one side, tissue on the other.
  bool is_target = false;
};

/// A point of a surface that has a name in the field, such as "pronasale".
struct Landmark {
  std::string name;
  glm::dvec3 position_m{0};  ///< phantom frame at rest, on the surface
};

/// What a part of the phantom measures, by calipers on its finished surface.
struct PhantomMeasure {
  std::string name;  ///< ends in the unit: mm, deg or none
  double value = 0;
  std::optional<double> target;  ///< value that was aimed at
};

/// An immutable phantom. Cheap to copy: the grids are shared.
///
/// @code
/// #include <iostream>
/// const phantoms::Phantom phantom = phantoms::make_phantom({.name = "cyst", .radius_m = 10e-3});
/// for (const phantoms::Surface& surface : phantom.surfaces()) {
///   std::cout << surface.name << ": " << phantom.materials()[surface.inside].name << "\n";
/// }
/// phantoms::write_phantom(phantom, "cyst.vdb");
/// @endcode
class Phantom {
 public:
  Phantom(std::string name,
          std::vector<Material> materials,
          MaterialIndex background,
          std::vector<Surface> surfaces,
          Box region_of_interest,
          glm::dvec3 suggested_position_m,
          std::shared_ptr<const Grids> grids,
          std::optional<Joint> joint = std::nullopt,
          PointScatterers scatterers = {});

  /// The same with more point scatterers.
  [[nodiscard]] Phantom with(const PointScatterers& more) const;
  /// The same with these named parts, one for each surface, and landmarks. Files of write_phantom()
  /// do not hold them.
  [[nodiscard]] Phantom with_parts(PhantomParts parts, std::vector<Landmark> landmarks) const;
  /// The same with these measures. Files of write_phantom() do not hold them.
  [[nodiscard]] Phantom with_measures(std::vector<PhantomMeasure> measures) const;

  const std::string& name() const { return name_; }
  const std::vector<Material>& materials() const { return materials_; }
  MaterialIndex background() const { return background_; }  ///< outside all surfaces
  const std::vector<Surface>& surfaces() const { return surfaces_; }
  /// The volume of interest that a sonographer would set; starts in the fluid. Phantom frame.
  const Box& region_of_interest() const { return region_of_interest_; }
  /// Position of the phantom's origin in the frame of the default probe, whose face is at z = 40
  /// mm.
  const glm::dvec3& suggested_position_m() const { return suggested_position_m_; }
  const Grids& grids() const { return *grids_; }
  /// The part that can turn by itself: the head of fetal_face.
  const std::optional<Joint>& joint() const { return joint_; }
  /// Echo beside the tissue, wherever they lie.
  const PointScatterers& scatterers() const { return *scatterers_; }
  std::shared_ptr<const PointScatterers> shared_scatterers() const { return scatterers_; }
  /// Null: its parts have no names but those of its surfaces.
  const PhantomParts* parts() const { return parts_.get(); }
  const std::vector<Landmark>& landmarks() const { return landmarks_; }
  /// Of the face, the labels of its identity. Empty: nothing was measured.
  const std::vector<PhantomMeasure>& measures() const { return measures_; }

 private:
  std::string name_;
  std::vector<Material> materials_;
  MaterialIndex background_;
  std::vector<Surface> surfaces_;
  Box region_of_interest_;
  glm::dvec3 suggested_position_m_;
  std::shared_ptr<const Grids> grids_;
  std::optional<Joint> joint_;
  std::shared_ptr<const PointScatterers> scatterers_;
  std::shared_ptr<const PhantomParts> parts_;
  std::vector<Landmark> landmarks_;
  std::vector<PhantomMeasure> measures_;
};

/// Rigid transform from the phantom frame to the probe frame: probe = rotation * phantom +
/// position.
///
/// @code
/// #include <iostream>
/// const phantoms::Placement placement{phantoms::rotation_xyz({0, 0.1, 0}), {0, 0, 0.11}};
/// const glm::dvec3 origin_m = placement.to_probe(glm::dvec3(0));  // (0, 0, 0.11), probe frame
/// const glm::dvec3 back_m = placement.to_phantom(origin_m);       // (0, 0, 0), phantom frame
/// std::cout << origin_m.z << " " << back_m.z;
/// @endcode
struct Placement {
  glm::dmat3 rotation{1.0};
  glm::dvec3 position_m{0};

  glm::dvec3 to_probe(const glm::dvec3& phantom_m) const {
    return rotation * phantom_m + position_m;
  }
  glm::dvec3 to_phantom(const glm::dvec3& probe_m) const;
  glm::dvec3 direction_to_phantom(const glm::dvec3& direction) const;
  glm::dvec3 direction_to_probe(const glm::dvec3& direction) const;
};

/// Rotation about x, then y, then z, by angles in radians.
glm::dmat3 rotation_xyz(const glm::dvec3& angles_rad);

/// Builds, imports or reads the named phantom. Throws InvalidPhantom as validate(), make_mesh(),
/// make_vdb() and read_phantom() do.
Phantom make_phantom(const PhantomOptions& options);

/// Writes `phantom` as .vdb (float level sets in metres, one for each surface; a float grid
/// "material" of table rows; the table itself and point scatterers as metadata) to exactly this
/// path, not atomically: an existing file is overwritten, and removed if writing fails. Equal
/// phantoms give equal bytes. Throws std::runtime_error "PATH: reason".
void write_phantom(const Phantom& phantom, const std::filesystem::path& path);

/// Reads what write_phantom wrote. Throws InvalidPhantom "PATH: reason" for anything else.
Phantom read_phantom(const std::filesystem::path& path);

}  // namespace wobblebench::phantoms
