// Writes phantoms as .vdb.
#include <openvdb/io/Stream.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/Prune.h>

#include <cstdint>
#include <sstream>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

#include "base/write_file.h"
#include "phantoms/float_grid.h"
#include "phantoms/grids.h"
#include "phantoms/io/scatterer_csv.h"
#include "phantoms/io/vdb_metadata.h"

namespace wobblebench::phantoms {
namespace {

// Row of the material table at every voxel, in painter's order. Of floats: OpenVDB's Python module
// reads no file that holds a grid of int32.
FloatGrid::Ptr material_grid(const Phantom& phantom) {
  FloatGrid::Ptr materials = create_level_set(1, double(phantom.background()));
  materials->setGridClass(openvdb::GRID_UNKNOWN);
  materials->setName("material");
  for (std::size_t i = 0; i < phantom.surfaces().size(); ++i) {
    const FloatGrid& distance = *phantom.grids().signed_distance[i];
    if (i == 0) materials->setTransform(distance.transform().copy());
    const auto inside = static_cast<float>(phantom.surfaces()[i].inside);
    auto accessor = materials->getAccessor();
    for (auto value = distance.cbeginValueAll(); value; ++value) {
      if (*value >= 0) continue;
      if (value.isVoxelValue()) {
        accessor.setValueOn(value.getCoord(), inside);
      } else {
        materials->tree().sparseFill(value.getBoundingBox(), inside, true);
      }
    }
  }
  openvdb::tools::prune(materials->tree());
  return materials;
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
  if (const auto& joint = phantom.joint()) {
    meta.insertMeta(kJointCenterKey, openvdb::Vec3DMetadata(to_vdb(joint->center_m)));
    number(kJointInnerKey, joint->inner_m);
    number(kJointOuterKey, joint->outer_m);
  }
  if (phantom.joint() && phantom.joint()->mouth) {
    const Mouth& mouth = *phantom.joint()->mouth;
    for (int axis = 0; axis < 3; ++axis) {
      meta.insertMeta(kMouthAxisKeys[axis], openvdb::Vec3DMetadata(to_vdb(mouth.axes[axis])));
    }
    meta.insertMeta(kMouthCenterKey, openvdb::Vec3DMetadata(to_vdb(mouth.center_m)));
    number(kMouthOpeningKey, mouth.opening_m);
    number(kMouthReachKey, mouth.reach_m);
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
    number(key_of("material", i, "sound_speed_m_s"), material.sound_speed_m_s);
    number(key_of("material", i, "impedance_rayl"), material.impedance_rayl);
    number(key_of("material", i, "attenuation_db_per_cm_mhz"), material.attenuation_db_per_cm_mhz);
    number(key_of("material", i, "backscatter_db"), material.backscatter_db);
    number(key_of("material", i, "roughness"), material.roughness);
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

std::string file_of(const Phantom& phantom) {
  openvdb::GridPtrVec grids;
  for (const auto& grid : phantom.grids().signed_distance) {
    // A shallow copy: the tree is shared and not changed.
    grids.push_back(openvdb::ConstPtrCast<FloatGrid>(grid));
  }
  grids.push_back(material_grid(phantom));
  std::ostringstream out(std::ios::binary);
  openvdb::io::Stream(out).write(grids, metadata_of(phantom));
  std::string bytes = std::move(out).str();
  bytes.replace(kIdentifierAt, kIdentifierSize, kIdentifierSize, '0');
  return bytes.replace(kIdentifierAt, kIdentifierSize, identifier_of(bytes));
}

}  // namespace

void write_phantom(const Phantom& phantom, const std::filesystem::path& path) {
  initialize_openvdb();
  const std::string bytes = file_of(phantom);
  try {
    write_file(path, bytes);
  } catch (...) {
    std::error_code ignored;
    if (std::filesystem::is_regular_file(path, ignored)) std::filesystem::remove(path, ignored);
    throw;
  }
}

}  // namespace wobblebench::phantoms
