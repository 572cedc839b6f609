// Writes phantoms as .vdb.
#include <openvdb/io/Stream.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/Prune.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <stdexcept>
#include <system_error>

#include "phantoms/float_grid.h"
#include "phantoms/grids.h"
#include "phantoms/io/vdb_metadata.h"

namespace wobblebench::phantoms {
namespace {

// Row of the material table at every voxel, in painter's order.
openvdb::Int32Grid::Ptr material_grid(const Phantom& phantom) {
  auto materials = openvdb::Int32Grid::create(phantom.background());
  materials->setName("material");
  for (std::size_t i = 0; i < phantom.surfaces().size(); ++i) {
    const FloatGrid& distance = *phantom.grids().signed_distance[i];
    if (i == 0) materials->setTransform(distance.transform().copy());
    const MaterialIndex inside = phantom.surfaces()[i].inside;
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
    grids.push_back(openvdb::ConstPtrCast<FloatGrid>(grid));
  }
  grids.push_back(material_grid(phantom));
  openvdb::io::Stream(out).write(grids, metadata_of(phantom));
  out.close();
  if (!out) throw std::runtime_error("the file could not be written whole: is the disk full?");
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

}  // namespace wobblebench::phantoms
