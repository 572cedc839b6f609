#include <openvdb/io/File.h>
#include <openvdb/io/Stream.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/Prune.h>

#include <cerrno>
#include <cmath>
#include <cstring>
#include <fstream>
#include <stdexcept>
#include <system_error>

#include "phantoms/grids.h"
#include "phantoms/level_set.h"
#include "phantoms/printable.h"

namespace wobblebench::phantoms {
namespace {

constexpr int kFormatVersion = 1;
constexpr const char* kVersionKey = "wobblebench_phantom_version";

openvdb::Vec3d to_vdb(const glm::dvec3& v) {
  return {v.x, v.y, v.z};
}
glm::dvec3 to_glm(const openvdb::Vec3d& v) {
  return {v.x(), v.y(), v.z()};
}

std::string key_of(const char* list, int index, const char* field) {
  return std::string(list) + "." + std::to_string(index) + "." + field;
}

// Table row at every voxel: later surfaces paint over earlier ones.
openvdb::Int32Grid::Ptr material_grid(const Phantom& phantom) {
  auto painted = openvdb::Int32Grid::create(phantom.background());
  painted->setName("material");
  for (std::size_t i = 0; i < phantom.surfaces().size(); ++i) {
    const openvdb::FloatGrid& distance = *phantom.grids().signed_distance[i];
    if (i == 0) painted->setTransform(distance.transform().copy());
    const MaterialIndex inside = phantom.surfaces()[i].inside;
    auto brush = painted->getAccessor();
    for (auto value = distance.cbeginValueAll(); value; ++value) {
      if (*value >= 0) continue;
      if (value.isVoxelValue()) {
        brush.setValueOn(value.getCoord(), inside);
      } else {
        painted->tree().sparseFill(value.getBoundingBox(), inside, true);
      }
    }
  }
  openvdb::tools::prune(painted->tree());
  return painted;
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
  integer(kVersionKey, kFormatVersion);
  text("phantom", phantom.name());
  integer("background", phantom.background());
  meta.insertMeta("region_low_m", openvdb::Vec3DMetadata(to_vdb(phantom.region_of_interest().low)));
  meta.insertMeta("region_high_m",
                  openvdb::Vec3DMetadata(to_vdb(phantom.region_of_interest().high)));
  meta.insertMeta("position_m", openvdb::Vec3DMetadata(to_vdb(phantom.suggested_position_m())));
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
    number(key_of("material", i, "sound_speed_m_s"), material.sound_speed_m_s);
    number(key_of("material", i, "impedance_rayl"), material.impedance_rayl);
    number(key_of("material", i, "attenuation_db_per_cm_mhz"), material.attenuation_db_per_cm_mhz);
    number(key_of("material", i, "backscatter_db"), material.backscatter_db);
    number(key_of("material", i, "roughness"), material.roughness);
    text(key_of("material", i, "source"), material.source);
  }
  return meta;
}

void write_stream(const Phantom& phantom, std::ofstream& out) {
  openvdb::GridPtrVec grids;
  for (const auto& grid : phantom.grids().signed_distance) {
    // A shallow copy: the tree is shared and not changed.
    grids.push_back(openvdb::ConstPtrCast<openvdb::FloatGrid>(grid));
  }
  grids.push_back(material_grid(phantom));
  openvdb::io::Stream(out).write(grids, metadata_of(phantom));
  out.close();
  if (!out) throw std::runtime_error("the file could not be written whole: is the disk full?");
}

// Metadata of a file, each entry required to be there with its type.
class Metadata {
 public:
  explicit Metadata(const openvdb::MetaMap& meta) : meta_(meta) {}

  template <class T>
  T get(const std::string& key) const {
    if (meta_[key] == nullptr) throw std::invalid_argument("has no metadata \"" + key + "\"");
    return meta_.metaValue<T>(key);
  }
  /// Reports hold these, and JSON holds nothing but UTF-8.
  std::string text(const std::string& key) const {
    auto value = get<std::string>(key);
    if (is_printable(value)) return value;
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

constexpr int kMostEntries = 10000;  // a damaged count must not fill the memory

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

void check_level_set(const std::string& name, const openvdb::FloatGrid& grid) {
  if (grid.getGridClass() != openvdb::GRID_LEVEL_SET) {
    throw std::invalid_argument("grid \"" + name + "\" is not of the class level set");
  }
  if (!grid.transform().isLinear() || !grid.hasUniformVoxels()) {
    throw std::invalid_argument("grid \"" + name + "\" does not have cubic voxels");
  }
  if (!(grid.background() > 0)) {
    throw std::invalid_argument("grid \"" + name + "\" has no positive background");
  }
  for (auto value = grid.cbeginValueAll(); value; ++value) {
    if (!std::isfinite(*value)) {
      throw std::invalid_argument("grid \"" + name + "\" holds a value that is not finite");
    }
  }
}

openvdb::FloatGrid::ConstPtr find_level_set(const openvdb::GridPtrVec& grids,
                                            const std::string& name) {
  for (const auto& grid : grids) {
    if (grid->getName() != name) continue;
    auto distances = openvdb::gridPtrCast<openvdb::FloatGrid>(grid);
    if (!distances) throw std::invalid_argument("grid \"" + name + "\" is not a float grid");
    check_level_set(name, *distances);
    return distances;
  }
  throw std::invalid_argument("has no grid \"" + name + "\"");
}

Phantom phantom_from(const openvdb::MetaMap& file_meta, const openvdb::GridPtrVec& found) {
  const Metadata meta(file_meta);
  if (file_meta[kVersionKey] == nullptr) {
    throw std::invalid_argument("an OpenVDB file, but not a phantom that this program wrote");
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
                 grids);
}

}  // namespace

void write_phantom(const Phantom& phantom, const std::filesystem::path& path) {
  initialize_openvdb();
  std::ofstream out(path, std::ios::binary | std::ios::trunc);
  if (!out)
    throw std::runtime_error(path.string() + ": cannot be created: " + std::strerror(errno));
  try {
    write_stream(phantom, out);
  } catch (const std::exception& error) {
    out.close();
    std::error_code ignored;
    std::filesystem::remove(path, ignored);
    throw std::runtime_error(path.string() + ": " + error.what());
  }
}

Phantom read_phantom(const std::filesystem::path& path) {
  initialize_openvdb();
  try {
    std::error_code error;
    if (!std::filesystem::is_regular_file(path, error)) {
      throw std::invalid_argument("no such file");
    }
    std::ifstream in(path, std::ios::binary);
    if (!in) throw std::invalid_argument("cannot be opened");
    // OpenVDB goes on with what it did not get from a file that is cut short; a size, say.
    in.exceptions(std::ios::failbit | std::ios::badbit);
    openvdb::io::Stream stream(in, /*delayLoad=*/false);
    return phantom_from(*stream.getMetadata(), *stream.getGrids());
  } catch (const std::ios::failure&) {
    throw InvalidPhantom(path.string() + ": not a readable OpenVDB file (it ends too early)");
  } catch (const openvdb::Exception& error) {
    throw InvalidPhantom(path.string() + ": not a readable OpenVDB file (" + error.what() + ")");
  } catch (const std::exception& error) {
    throw InvalidPhantom(path.string() + ": " + error.what());
  }
}

}  // namespace wobblebench::phantoms
