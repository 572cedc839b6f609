// NRRD files (teem.sourceforge.net/nrrd/format.html): .nrrd, and .nhdr with the voxels beside it.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "bench/exchange/files/voxel_file.h"

namespace wobblebench::bench {

/// A header to write. Voxels follow it in this machine's byte order.
struct NrrdHeader {
  Element element = Element::uint8;
  std::vector<std::uint64_t> sizes;  ///< fastest axis first
  /// mm, left-posterior-superior; empty: the grid has no positions. An axis of time has none.
  std::vector<std::optional<glm::dvec3>> directions_mm;
  glm::dvec3 origin_mm{0};
  std::vector<std::string> kinds;                           ///< "domain", "list"
  std::vector<std::string> labels;                          ///< of the axes
  std::vector<std::pair<std::string, std::string>> fields;  ///< key:=value, in this order
};

std::string nrrd_text(const NrrdHeader& header);

/// Reads a header. `fields` are its key:=value pairs; positions are turned into
/// left-posterior-superior. Throws UserError "PATH: …" for what is no NRRD, lies in several
/// files, or does not say what is needed.
VoxelFile read_nrrd(const std::filesystem::path& path);

}  // namespace wobblebench::bench
