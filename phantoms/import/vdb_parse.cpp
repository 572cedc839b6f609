#include "phantoms/import/parsers.h"

#include <openvdb/io/Archive.h>
#include <openvdb/io/GridDescriptor.h>
#include <openvdb/io/Stream.h>
#include <openvdb/math/Maps.h>
#include <openvdb/openvdb.h>

#include <algorithm>
#include <fstream>
#include <stdexcept>
#include <string>

namespace wobblebench::phantoms {
namespace {

using Grid = openvdb::FloatGrid;

// Reads the descriptor and metadata of each grid and skips its values. Files that were written as a
// stream hold no offsets to skip by; they are not read.
class FileSummary : public openvdb::io::Archive {
 public:
  openvdb::SharedPtr<Archive> copy() const override {
    return openvdb::SharedPtr<Archive>(new FileSummary(*this));
  }
  double stated_bytes(std::istream& in) {
    readHeader(in);
    setFormatVersion(in);
    setLibraryVersion(in);
    setDataCompression(in);
    openvdb::MetaMap of_file;
    of_file.readMeta(in);
    if (!inputHasGridOffsets()) return 0;
    double bytes = 0;
    for (int left = readGridCount(in); left > 0; --left) {
      openvdb::io::GridDescriptor descriptor;
      descriptor.read(in);
      descriptor.seekToGrid(in);
      readGridCompression(in);
      openvdb::MetaMap of_grid;
      of_grid.readMeta(in);
      const auto stated =
          of_grid.getMetadata<openvdb::Int64Metadata>(openvdb::GridBase::META_FILE_MEM_BYTES);
      if (stated) bytes += double(stated->value());
      descriptor.seekToEnd(in);
    }
    return bytes;
  }
};

std::ifstream open(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in) throw std::invalid_argument("cannot be opened");
  // OpenVDB does not check its reads: from a truncated file it would take arbitrary sizes.
  in.exceptions(std::ios::failbit | std::ios::badbit);
  return in;
}

void write_metadata(const openvdb::MetaMap& metadata, MessageWriter& out) {
  for (auto entry = metadata.beginMeta(); entry != metadata.endMeta(); ++entry) {
    const openvdb::Metadata& value = *entry->second;
    const auto head = [&](VdbMetadata type) {
      out.put(type);
      out.text(entry->first);
    };
    if (const auto* text = dynamic_cast<const openvdb::StringMetadata*>(&value)) {
      head(VdbMetadata::text);
      out.text(text->value());
    } else if (const auto* number = dynamic_cast<const openvdb::DoubleMetadata*>(&value)) {
      head(VdbMetadata::number);
      out.put(number->value());
    } else if (const auto* integer = dynamic_cast<const openvdb::Int32Metadata*>(&value)) {
      head(VdbMetadata::integer);
      out.put(integer->value());
    } else if (const auto* flag = dynamic_cast<const openvdb::BoolMetadata*>(&value)) {
      head(VdbMetadata::flag);
      out.put(std::int32_t{flag->value()});
    } else if (const auto* vector = dynamic_cast<const openvdb::Vec3DMetadata*>(&value)) {
      head(VdbMetadata::vector);
      for (int axis = 0; axis < 3; ++axis) out.put(vector->value()[axis]);
    }
  }
  out.put(VdbMetadata::end);
}

void write_tiles(const Grid& grid, MessageWriter& out) {
  auto tile = grid.cbeginValueAll();
  tile.setMaxDepth(Grid::ValueAllCIter::LEAF_DEPTH - 1);
  for (; tile; ++tile) {
    // What a new branch holds anyway.
    if (!tile.isValueOn() && *tile == grid.background()) continue;
    const openvdb::Coord low = tile.getBoundingBox().min();
    out.put(VdbTile{{low.x(), low.y(), low.z()},
                    static_cast<std::int32_t>(tile.getLevel()),
                    tile.isValueOn() ? 1 : 0,
                    *tile});
  }
  out.put(VdbTile{{}, kNoMoreTiles, 0, 0});
}

void write_leaves(const Grid& grid, MessageWriter& out) {
  out.put(std::uint64_t{grid.tree().leafCount()});
  for (auto leaf = grid.tree().cbeginLeaf(); leaf; ++leaf) {
    VdbLeaf record{};
    record.low = {leaf->origin().x(), leaf->origin().y(), leaf->origin().z()};
    for (openvdb::Index i = 0; i < VdbLeaf::kVoxels; ++i) {
      record.values[i] = leaf->getValue(i);
      record.active[i / 64] |= std::uint64_t{leaf->isValueOn(i)} << (i % 64);
    }
    out.put(record);
  }
}

void write_distances(const Grid& distances, MessageWriter& out) {
  const openvdb::Mat4d matrix = distances.transform().baseMap()->getAffineMap()->getMat4();
  for (int i = 0; i < 16; ++i) out.put(matrix.asPointer()[i]);
  out.put(distances.background());
  write_tiles(distances, out);
  write_leaves(distances, out);
}

void write_grid(const openvdb::GridBase& grid, MessageWriter& out) {
  const bool is_float = grid.isType<Grid>(), is_double = grid.isType<openvdb::DoubleGrid>();
  const bool are_distances = (is_float || is_double) && grid.transform().isLinear();
  out.put(are_distances ? VdbContents::distances : VdbContents::name_alone);
  out.text(grid.getName());
  out.text(grid.valueType());
  out.text(openvdb::GridBase::gridClassToString(grid.getGridClass()));
  if (!are_distances) return;
  if (is_float) {
    write_distances(dynamic_cast<const Grid&>(grid), out);
  } else {
    write_distances(Grid(dynamic_cast<const openvdb::DoubleGrid&>(grid)), out);
  }
}

void write_file(const std::filesystem::path& path, MessageWriter& out) {
  {
    std::ifstream in = open(path);
    const auto file_bytes = double(std::filesystem::file_size(path));
    check_bytes(std::max(FileSummary().stated_bytes(in), file_bytes), ": use larger voxels");
  }
  std::ifstream in = open(path);
  openvdb::io::Stream stream(in, /*delayLoad=*/false);
  write_metadata(*stream.getMetadata(), out);
  for (const auto& grid : *stream.getGrids()) {
    if (grid) write_grid(*grid, out);
  }
  out.put(VdbContents::end);
}

}  // namespace

void write_vdb_message(const std::filesystem::path& path, MessageWriter& out) {
  openvdb::initialize();
  try {
    write_file(path, out);
  } catch (const std::ios::failure&) {
    throw std::invalid_argument("not a readable OpenVDB file (it ends too early)");
  } catch (const openvdb::Exception& error) {
    throw std::invalid_argument(std::string("not a readable OpenVDB file (") + error.what() + ")");
  }
}

}  // namespace wobblebench::phantoms
