// Reads phantoms that phantom_vdb.cpp wrote.
#include <cmath>
#include <stdexcept>

#include "base/text.h"
#include "phantoms/float_grid.h"
#include "phantoms/grids.h"
#include "phantoms/io/import_process.h"
#include "phantoms/io/scatterer_csv.h"
#include "phantoms/io/vdb_file.h"
#include "phantoms/io/vdb_metadata.h"

namespace wobblebench::phantoms {
namespace {

// Metadata of a file; a missing entry or one of another type is an error.
class Metadata {
 public:
  explicit Metadata(const openvdb::MetaMap& meta) : meta_(meta) {}

  template <class T>
  T get(const std::string& key) const {
    if (meta_[key] == nullptr) throw std::invalid_argument("has no metadata \"" + key + "\"");
    return meta_.metaValue<T>(key);
  }
  /// Printable, since reports show it and JSON is UTF-8.
  std::string text(const std::string& key) const {
    auto value = get<std::string>(key);
    if (is_printable_text(value)) return value;
    throw std::invalid_argument("metadata \"" + key + "\" is not printable UTF-8 text");
  }
  int integer(const std::string& key, int low, int high) const {
    const int value = get<openvdb::Int32>(key);
    if (value >= low && value <= high) return value;
    throw std::invalid_argument("metadata \"" + key + "\" = " + std::to_string(value) +
                                ": must be within " + std::to_string(low) + " and " +
                                std::to_string(high));
  }
  double number(const std::string& key) const { return finite(key, get<double>(key)); }
  glm::dvec3 vector(const std::string& key) const {
    const glm::dvec3 value = to_glm(get<openvdb::Vec3d>(key));
    for (int axis = 0; axis < 3; ++axis) finite(key, value[axis]);
    return value;
  }

 private:
  static double finite(const std::string& key, double value) {
    if (std::isfinite(value)) return value;
    throw std::invalid_argument("metadata \"" + key + "\" is not a finite number");
  }
  const openvdb::MetaMap& meta_;
};

constexpr int kMostEntries = 10000;  // a damaged count must not exhaust memory

std::vector<Material> read_materials(const Metadata& meta) {
  std::vector<Material> materials;
  const int count = meta.integer("materials", 1, kMostEntries);
  for (int i = 0; i < count; ++i) {
    materials.push_back({meta.text(key_of("material", i, "name")),
                         meta.number(key_of("material", i, "sound_speed_m_s")),
                         meta.number(key_of("material", i, "impedance_rayl")),
                         meta.number(key_of("material", i, "attenuation_db_per_cm_mhz")),
                         meta.number(key_of("material", i, "backscatter_db")),
                         meta.number(key_of("material", i, "roughness")),
                         meta.text(key_of("material", i, "source"))});
  }
  return materials;
}

std::optional<Mouth> read_mouth(const openvdb::MetaMap& file_meta, const Metadata& meta) {
  if (file_meta[kMouthCenterKey] == nullptr) return std::nullopt;
  Mouth mouth;
  for (int axis = 0; axis < 3; ++axis) mouth.axes[axis] = meta.vector(kMouthAxisKeys[axis]);
  mouth.center_m = meta.vector(kMouthCenterKey);
  mouth.opening_m = meta.number(kMouthOpeningKey);
  mouth.reach_m = meta.number(kMouthReachKey);
  if (is_possible(mouth)) return mouth;
  throw std::invalid_argument("metadata \"" + std::string(kMouthOpeningKey) +
                              "\", axes and reach are not those of a mouth");
}

std::optional<Joint> read_joint(const openvdb::MetaMap& file_meta, const Metadata& meta) {
  if (file_meta[kJointCenterKey] == nullptr) return std::nullopt;
  const Joint joint{meta.vector(kJointCenterKey),
                    meta.number(kJointInnerKey),
                    meta.number(kJointOuterKey),
                    read_mouth(file_meta, meta)};
  if (joint.inner_m >= 0 && joint.inner_m < joint.outer_m) return joint;
  throw std::invalid_argument("metadata \"" + std::string(kJointOuterKey) +
                              "\" must be larger than \"" + kJointInnerKey + "\"");
}

PointScatterers read_scatterers(const openvdb::MetaMap& file_meta, const Metadata& meta) {
  if (file_meta[kScatterersKey] == nullptr) return {};
  try {
    return scatterers_from_csv(meta.get<std::string>(kScatterersKey));
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument("metadata \"" + std::string(kScatterersKey) +
                                "\": " + error.what());
  }
}

FloatGrid::ConstPtr find_level_set(const std::vector<VdbGrid>& grids, const std::string& name) {
  for (const auto& grid : grids) {
    if (grid.name != name) continue;
    if (!grid.distances) throw std::invalid_argument("grid \"" + name + "\" is not a float grid");
    check_level_set(name, *grid.distances);
    return grid.distances;
  }
  throw std::invalid_argument("has no grid \"" + name + "\"");
}

Phantom phantom_from(const openvdb::MetaMap& file_meta, const std::vector<VdbGrid>& found) {
  const Metadata meta(file_meta);
  if (file_meta[kVersionKey] == nullptr) {
    throw std::invalid_argument(
        "an OpenVDB file, but not a phantom that this program wrote; "
        "name = \"vdb\" imports level sets of others");
  }
  meta.integer(kVersionKey, kFormatVersion, kFormatVersion);
  std::vector<Material> materials = read_materials(meta);
  const int last_row = int(materials.size()) - 1;
  std::vector<Surface> surfaces;
  auto grids = std::make_shared<Grids>();
  const int count = meta.integer("surfaces", 0, kMostEntries);
  for (int i = 0; i < count; ++i) {
    surfaces.push_back({meta.text(key_of("surface", i, "name")),
                        meta.integer(key_of("surface", i, "inside"), 0, last_row),
                        meta.get<bool>(key_of("surface", i, "is_target"))});
    grids->signed_distance.push_back(find_level_set(found, surfaces.back().name));
  }
  return Phantom(meta.text("phantom"),
                 std::move(materials),
                 meta.integer("background", 0, last_row),
                 std::move(surfaces),
                 {meta.vector("region_low_m"), meta.vector("region_high_m")},
                 meta.vector("position_m"),
                 grids,
                 read_joint(file_meta, meta),
                 read_scatterers(file_meta, meta));
}

}  // namespace

Phantom read_phantom(const std::filesystem::path& path) {
  try {
    const VdbFile file = read_vdb(path);
    return phantom_from(file.metadata, file.grids);
  } catch (const ImportUnavailable&) {
    throw;
  } catch (const openvdb::Exception& error) {
    throw InvalidPhantom("file = \"" + path.string() + "\": not a readable phantom (" +
                         error.what() + ")");
  } catch (const std::exception& error) {
    throw InvalidPhantom("file = \"" + path.string() + "\": " + error.what());
  }
}

}  // namespace wobblebench::phantoms
