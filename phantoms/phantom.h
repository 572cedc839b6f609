// What is scanned: closed surfaces as OpenVDB level sets, the materials that they enclose, and the
// exact truth about them. OpenVDB itself stays behind phantoms/grids.h, for .cpp files only.
//
// Frame of reference ("phantom frame", docs/units.md): metres, right-handed, the same axes as the
// probe frame: x to the right of the picture, y down the picture, z away from the probe. The origin
// is the phantom's own centre; `Placement` puts it into the probe frame.
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

namespace wobblebench::phantoms {

struct Grids;  // phantoms/grids.h

/// An axis-aligned box.
struct Box {
  glm::dvec3 low{0};
  glm::dvec3 high{0};
};

/// One closed surface. Later surfaces of a phantom win where they overlap earlier ones.
struct Surface {
  std::string name;
  MaterialIndex inside = 0;  ///< material within the surface
  bool is_target =
      false;  ///< a surface that the renderer looks for: fluid on one side, tissue on the other
};

/// An immutable phantom. Cheap to copy: the grids are shared.
class Phantom {
 public:
  Phantom(std::string name,
          std::vector<Material> materials,
          MaterialIndex background,
          std::vector<Surface> surfaces,
          Box region_of_interest,
          glm::dvec3 suggested_position_m,
          std::shared_ptr<const Grids> grids,
          std::optional<Joint> joint = std::nullopt);

  const std::string& name() const { return name_; }
  const std::vector<Material>& materials() const { return materials_; }
  MaterialIndex background() const { return background_; }  ///< outside all surfaces
  const std::vector<Surface>& surfaces() const { return surfaces_; }
  /// Where a sonographer would set the box of the picture: it starts in the fluid. Phantom frame.
  const Box& region_of_interest() const { return region_of_interest_; }
  /// Where the phantom's origin belongs in the probe frame of the default probe (face at z = 40
  /// mm).
  const glm::dvec3& suggested_position_m() const { return suggested_position_m_; }
  const Grids& grids() const { return *grids_; }
  /// What of it can turn by itself: the head of fetal_face.
  const std::optional<Joint>& joint() const { return joint_; }

 private:
  std::string name_;
  std::vector<Material> materials_;
  MaterialIndex background_;
  std::vector<Surface> surfaces_;
  Box region_of_interest_;
  glm::dvec3 suggested_position_m_;
  std::shared_ptr<const Grids> grids_;
  std::optional<Joint> joint_;
};

/// Where the phantom stands: probe = rotation * phantom + position.
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

/// Rotations about x, then y, then z, in radians.
glm::dmat3 rotation_xyz(const glm::dvec3& angles_rad);

/// Builds, imports or reads the named phantom. Throws InvalidPhantom as validate(), make_mesh(),
/// make_vdb() and read_phantom() do.
Phantom make_phantom(const PhantomOptions& options);

/// Writes `phantom` as .vdb (float level sets in metres, one for each surface; an Int32 grid
/// "material" of table rows; the table itself as metadata) to exactly this path. A file that cannot
/// be written whole is removed; who must not lose an older one, or may be interrupted, writes to a
/// name of its own and renames. Throws std::runtime_error "PATH: reason".
void write_phantom(const Phantom& phantom, const std::filesystem::path& path);

/// Reads what write_phantom wrote. Throws InvalidPhantom "PATH: reason" for anything else.
Phantom read_phantom(const std::filesystem::path& path);

}  // namespace wobblebench::phantoms
