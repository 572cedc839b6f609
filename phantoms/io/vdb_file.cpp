#include "phantoms/io/vdb_file.h"

#include <openvdb/io/Archive.h>
#include <openvdb/io/GridDescriptor.h>
#include <openvdb/io/Stream.h>

#include <cmath>
#include <fstream>
#include <stdexcept>
#include <system_error>

#include "phantoms/float_grid.h"

namespace wobblebench::phantoms {
namespace {

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

// Calls use(stream); throws every failure as std::invalid_argument with one line.
template <class Use>
auto with_file(const std::filesystem::path& path, const Use& use) {
  initialize_openvdb();
  try {
    std::error_code error;
    if (!std::filesystem::is_regular_file(path, error)) {
      throw std::invalid_argument("no such file");
    }
    std::ifstream in(path, std::ios::binary);
    if (!in) throw std::invalid_argument("cannot be opened");
    // OpenVDB does not check its reads: from a truncated file it would take arbitrary sizes.
    in.exceptions(std::ios::failbit | std::ios::badbit);
    return use(in);
  } catch (const std::ios::failure&) {
    throw std::invalid_argument("not a readable OpenVDB file (it ends too early)");
  } catch (const openvdb::Exception& error) {
    throw std::invalid_argument(std::string("not a readable OpenVDB file (") + error.what() + ")");
  }
}

}  // namespace

VdbFile read_vdb(const std::filesystem::path& path) {
  return with_file(path, [](std::ifstream& in) {
    openvdb::io::Stream stream(in, /*delayLoad=*/false);
    return VdbFile{*stream.getGrids(), *stream.getMetadata()};
  });
}

double stated_bytes(const std::filesystem::path& path) {
  return with_file(path, [](std::ifstream& in) { return FileSummary().stated_bytes(in); });
}

void check_level_set(const std::string& name, const FloatGrid& grid) {
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

}  // namespace wobblebench::phantoms
