// Writes phantoms as .vdb, and reads them back.
#include <openvdb/io/Stream.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/Prune.h>

#include <cmath>
#include <cstdint>
#include <sstream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

#include "base/file.h"
#include "base/text.h"
#include "phantoms/float_grid.h"
#include "phantoms/grids.h"
#include "phantoms/io/import_process.h"
#include "phantoms/io/scatterer_file.h"
#include "phantoms/io/vdb_file.h"
#include "phantoms/io/vdb_lattice.h"
#include "phantoms/label_finder.h"

namespace wobblebench::phantoms {
namespace {

constexpr int kFormatVersion = 1;

// All three in the file of a phantom with a joint, else none.
constexpr const char* kJointCenterKey = "joint_center_m";
constexpr const char* kJointInnerKey = "joint_inner_m";
constexpr const char* kJointOuterKey = "joint_outer_m";

// All of them for a joint with a mouth, else none.
constexpr const char* kMouthCenterKey = "mouth_center_m";
constexpr const char* kMouthAxisKeys[] = {"mouth_right", "mouth_down", "mouth_back"};
constexpr const char* kMouthOpeningKey = "mouth_opening_m";
constexpr const char* kMouthReachKey = "mouth_reach_m";

// Point scatterers, as scatterers_to_csv() writes them; missing: there are none.
constexpr const char* kScatterersKey = "scatterers";

constexpr std::pair<const char*, double Material::*> kMaterialNumbers[] = {
    {"sound_speed_m_s", &Material::sound_speed_m_s},
    {"impedance_rayl", &Material::impedance_rayl},
    {"attenuation_db_per_cm_mhz", &Material::attenuation_db_per_cm_mhz},
    {"backscatter_db", &Material::backscatter_db},
    {"roughness", &Material::roughness}};

std::string key_of(const char* list, int index, const char* field) {
  return std::string(list) + "." + std::to_string(index) + "." + field;
}

// A number at every voxel, in painter's order. Of floats: OpenVDB's Python module reads no file
// that holds a grid of int32.
FloatGrid::Ptr painted_grid(const Phantom& phantom, const char* name, double background) {
  FloatGrid::Ptr painted = create_level_set(1, background);
  painted->setGridClass(openvdb::GRID_UNKNOWN);
  painted->setName(name);
  if (!phantom.surfaces().empty()) {
    painted->setTransform(phantom.grids().signed_distance[0]->transform().copy());
  }
  return painted;
}

// Paints what a surface encloses: paint(box) for each box of voxels, or one voxel, within it.
template <class Paint>
void for_inside(const FloatGrid& distance, const Paint& paint) {
  for (auto value = distance.cbeginValueAll(); value; ++value) {
    if (*value < 0) paint(value.getBoundingBox());
  }
}

// Row of the material table at every voxel.
FloatGrid::Ptr material_grid(const Phantom& phantom) {
  FloatGrid::Ptr materials = painted_grid(phantom, "material", double(phantom.background()));
  for (std::size_t i = 0; i < phantom.surfaces().size(); ++i) {
    const auto inside = static_cast<float>(phantom.surfaces()[i].inside);
    auto accessor = materials->getAccessor();
    for_inside(*phantom.grids().signed_distance[i], [&](const openvdb::CoordBBox& box) {
      if (box.volume() == 1) {
        accessor.setValueOn(box.min(), inside);
      } else {
        materials->tree().sparseFill(box, inside, true);
      }
    });
  }
  openvdb::tools::prune(materials->tree());
  return materials;
}

// Label of the part at every voxel.
FloatGrid::Ptr label_grid(const Phantom& phantom) {
  const PhantomParts* parts = phantom.parts();
  const int background =
      parts != nullptr ? static_cast<int>(parts->background) : kUnnamedBackground;
  FloatGrid::Ptr labels = painted_grid(phantom, "part", background);
  const LabelFinder finder(phantom);
  for (std::size_t i = 0; i < phantom.surfaces().size(); ++i) {
    auto accessor = labels->getAccessor();
    for_inside(*phantom.grids().signed_distance[i], [&](const openvdb::CoordBBox& box) {
      for (auto voxel = box.begin(); voxel; ++voxel) {
        const glm::dvec3 at_m = to_glm(labels->indexToWorld(*voxel));
        accessor.setValueOn(*voxel, finder.inside(static_cast<int>(i), at_m));
      }
    });
  }
  openvdb::tools::prune(labels->tree());
  return labels;
}

openvdb::MetaMap metadata_of(const Phantom& phantom) {
  openvdb::MetaMap meta;
  const auto text = [&](const std::string& key, const std::string& value) {
    meta.insertMeta(key, openvdb::StringMetadata(value));
  };
  const auto number = [&](const std::string& key, double value) {
    meta.insertMeta(key, openvdb::DoubleMetadata(value));
  };
  const auto integer = [&](const std::string& key, int value) {
    meta.insertMeta(key, openvdb::Int32Metadata(value));
  };
  const auto vector = [&](const std::string& key, const glm::dvec3& value) {
    meta.insertMeta(key, openvdb::Vec3DMetadata(to_vdb(value)));
  };
  integer(kVersionKey, kFormatVersion);
  text("phantom", phantom.name());
  integer("background", phantom.background());
  vector("region_low_m", phantom.region_of_interest().low);
  vector("region_high_m", phantom.region_of_interest().high);
  vector("position_m", phantom.suggested_position_m());
  if (const auto& joint = phantom.joint()) {
    vector(kJointCenterKey, joint->center_m);
    number(kJointInnerKey, joint->inner_m);
    number(kJointOuterKey, joint->outer_m);
    if (const auto& mouth = joint->mouth) {
      for (int axis = 0; axis < 3; ++axis) vector(kMouthAxisKeys[axis], mouth->axes[axis]);
      vector(kMouthCenterKey, mouth->center_m);
      number(kMouthOpeningKey, mouth->opening_m);
      number(kMouthReachKey, mouth->reach_m);
    }
  }
  if (!phantom.scatterers().empty()) text(kScatterersKey, scatterers_to_csv(phantom.scatterers()));
  integer("surfaces", int(phantom.surfaces().size()));
  for (int i = 0; i < int(phantom.surfaces().size()); ++i) {
    const Surface& surface = phantom.surfaces()[i];
    text(key_of("surface", i, "name"), surface.name);
    integer(key_of("surface", i, "inside"), surface.inside);
    meta.insertMeta(key_of("surface", i, "is_target"), openvdb::BoolMetadata(surface.is_target));
  }
  integer("materials", int(phantom.materials().size()));
  for (int i = 0; i < int(phantom.materials().size()); ++i) {
    const Material& material = phantom.materials()[i];
    text(key_of("material", i, "name"), material.name);
    for (const auto& [field, value] : kMaterialNumbers) {
      number(key_of("material", i, field), material.*value);
    }
    text(key_of("material", i, "source"), material.source);
  }
  return meta;
}

// A file begins with magic number, version of the format, version of the library (two numbers) and
// whether it holds offsets; then its identifier, which OpenVDB draws at random.
constexpr std::size_t kIdentifierAt = 8 + 4 + 8 + 1, kIdentifierSize = 36;

// A UUID of version 8 (RFC 9562) that follows from the content: equal phantoms give equal files.
std::string identifier_of(std::string_view content) {
  std::string hash;
  for (const std::uint64_t start : {14695981039346656037u, 1099511628211u}) {  // FNV-1a
    std::uint64_t value = start;
    for (const char c : content) {
      value = (value ^ static_cast<unsigned char>(c)) * 1099511628211u;
    }
    for (int digit = 0; digit < 16; ++digit) hash += "0123456789abcdef"[value >> 4 * digit & 15];
  }
  hash[12] = '8';
  hash[16] = 'a';
  for (const std::size_t dash : {8, 13, 18, 23}) hash.insert(dash, 1, '-');
  return hash;
}

std::string file_of(const openvdb::GridPtrVec& grids, const openvdb::MetaMap& metadata) {
  std::ostringstream out(std::ios::binary);
  openvdb::io::Stream(out).write(grids, metadata);
  std::string bytes = std::move(out).str();
  bytes.replace(kIdentifierAt, kIdentifierSize, kIdentifierSize, '0');
  return bytes.replace(kIdentifierAt, kIdentifierSize, identifier_of(bytes));
}

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

constexpr int kMostListed = 10000;  // a damaged count must not exhaust memory

std::vector<Material> read_materials(const Metadata& meta) {
  std::vector<Material> materials(meta.integer("materials", 1, kMostListed));
  for (int i = 0; i < int(materials.size()); ++i) {
    materials[i].name = meta.text(key_of("material", i, "name"));
    for (const auto& [field, value] : kMaterialNumbers) {
      materials[i].*value = meta.number(key_of("material", i, field));
    }
    materials[i].source = meta.text(key_of("material", i, "source"));
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
    if (!grid.distances)
      throw std::invalid_argument("grid \"" + name + "\" is no grid of floats or doubles");
    const FloatGrid::Ptr distances = along_axes(grid.distances);
    check_level_set(name, *distances);
    return distances;
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
  const int count = meta.integer("surfaces", 0, kMostListed);
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

namespace {

// A file that was begun is removed if writing fails.
void write_whole(const std::filesystem::path& path, const std::string& bytes) {
  try {
    write_file(path, bytes);
  } catch (...) {
    std::error_code ignored;
    if (std::filesystem::is_regular_file(path, ignored)) std::filesystem::remove(path, ignored);
    throw;
  }
}

}  // namespace

void write_phantom(const Phantom& phantom, const std::filesystem::path& path) {
  initialize_openvdb();
  openvdb::GridPtrVec grids;
  for (const auto& grid : phantom.grids().signed_distance) {
    // A shallow copy: the tree is shared and not changed.
    grids.push_back(openvdb::ConstPtrCast<FloatGrid>(grid));
  }
  grids.push_back(material_grid(phantom));
  write_whole(path, file_of(grids, metadata_of(phantom)));
}

void write_labels(const Phantom& phantom, const std::filesystem::path& path) {
  initialize_openvdb();
  openvdb::MetaMap names;
  for (const LabelName& name : label_names(phantom)) {
    names.insertMeta("label." + std::to_string(name.label), openvdb::StringMetadata(name.name));
  }
  write_whole(path, file_of({label_grid(phantom)}, names));
}

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
