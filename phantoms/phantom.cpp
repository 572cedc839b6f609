#include "phantoms/phantom.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <glm/matrix.hpp>
#include <glm/trigonometric.hpp>
#include <sstream>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "phantoms/builders.h"
#include "phantoms/grids.h"

namespace wobblebench::phantoms {
namespace {

InvalidPhantom refusal(const std::string& key,
                       const std::string& value,
                       const std::string& allowed) {
  return InvalidPhantom(key + " = " + value + ": " + allowed);
}

std::string quoted(const std::string& text) {
  return '"' + text + '"';
}

// The phantoms module stands alone, so it brings its own visitor for its options.
class RangeCheck {
 public:
  void text(const char*, const std::string&) {}
  void real(const char* key, double value_si, double unit, double min, double max) {
    const double value = value_si / unit;
    const double rounding = 1e-12 * (std::abs(min) + std::abs(max));
    if (value >= min - rounding && value <= max + rounding) return;
    std::ostringstream shown, allowed;
    shown << value;
    allowed << "must be within " << min << " and " << max;
    throw refusal(key, shown.str(), allowed.str());
  }
};

struct Builder {
  std::string name;
  Phantom (*build)(const PhantomOptions&);
  double coarsest_voxel_m;  ///< coarser voxels lose what the phantom is for
};

const std::vector<Builder>& builders() {
  static const std::vector<Builder> all = {{"fetal_face", make_fetal_face, 2e-3},
                                           {"plane", make_plane, 5e-3},
                                           {"sphere", make_sphere, 5e-3},
                                           {"points", make_points, 0.5e-3},
                                           {"speckle_block", make_speckle_block, 5e-3}};
  return all;
}

void check_voxel(const Builder& builder, const PhantomOptions& options) {
  double coarsest_m = builder.coarsest_voxel_m;
  if (builder.name == "sphere") coarsest_m = std::min(coarsest_m, options.radius_m / 2);
  if (options.voxel_m <= coarsest_m * (1 + 1e-12)) return;
  std::ostringstream shown, allowed;
  shown << options.voxel_m * 1e3;
  allowed << "must be at most " << coarsest_m * 1e3 << " for the phantom " << builder.name;
  throw refusal("voxel_mm", shown.str(), allowed.str());
}

const Builder& builder_of(const std::string& name) {
  std::string known;
  for (const Builder& builder : builders()) {
    if (builder.name == name) return builder;
    known += builder.name + ", ";
  }
  throw refusal("name", quoted(name), "must be one of " + known + "file");
}

void check_file(const std::string& file) {
  if (file.empty()) throw refusal("file", quoted(file), "must be the path of a .vdb");
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error)) {
    const bool missing = !error || error == std::errc::no_such_file_or_directory;
    throw refusal("file", quoted(file), missing ? "no such file" : error.message());
  }
  if (std::filesystem::file_size(file, error) == 0) {
    throw refusal("file", quoted(file), "not a readable OpenVDB file (it is empty)");
  }
  if (::access(file.c_str(), R_OK) != 0) throw refusal("file", quoted(file), "cannot be read");
}

}  // namespace

Phantom::Phantom(std::string name,
                 std::vector<Material> materials,
                 MaterialIndex background,
                 std::vector<Surface> surfaces,
                 Box region_of_interest,
                 glm::dvec3 suggested_position_m,
                 std::shared_ptr<const Grids> grids)
    : name_(std::move(name)),
      materials_(std::move(materials)),
      background_(background),
      surfaces_(std::move(surfaces)),
      region_of_interest_(region_of_interest),
      suggested_position_m_(suggested_position_m),
      grids_(std::move(grids)) {
  if (grids_ == nullptr || grids_->signed_distance.size() != surfaces_.size()) {
    throw std::logic_error("phantom " + name_ + ": needs one grid for each surface");
  }
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

const std::vector<std::string>& phantom_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all;
    for (const Builder& builder : builders()) all.push_back(builder.name);
    return all;
  }();
  return names;
}

MaterialIndex material_index(const std::string& name) {
  return MaterialIndex(&material(name) - material_table().data());
}

void validate(const PhantomOptions& options) {
  PhantomOptions checked = options;
  RangeCheck check;
  describe(checked, check);
  if (options.name == "file") {
    check_file(options.file);
  } else {
    check_voxel(builder_of(options.name), options);
  }
}

Phantom make_phantom(const PhantomOptions& options) {
  validate(options);
  if (options.name == "file") return read_phantom(options.file);
  return builder_of(options.name).build(options);
}

}  // namespace wobblebench::phantoms
