// MetaImage files: .mha, and .mhd with the voxels beside it; with the fields that PLUS and
// SlicerIGSIO write for each frame of a sequence (Seq_FrameNNNN_NAME).
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "bench/exchange/files/voxel_file.h"

namespace wobblebench::bench {

/// A header to write. Voxels follow it in this machine's byte order.
struct MetaHeader {
  Element element = Element::uint8;
  std::vector<std::uint64_t> sizes;  ///< fastest axis first
  std::vector<double> spacing;       ///< along each axis
  /// Columns are the axes' directions; nine numbers, row by row as MetaImage has them: those of the
  /// first axis first. Of three axes; the identity for a sequence.
  std::vector<double> directions = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  glm::dvec3 origin_mm{0};
  std::vector<std::pair<std::string, std::string>> fields;  ///< in this order
};

std::string meta_image_text(const MetaHeader& header);

/// Reads a header. `fields` are all that it has. Spacing that is not given is none. Throws
/// UserError "PATH: …" for what is no MetaImage, or lacks its voxels.
VoxelFile read_meta_image(const std::filesystem::path& path);

/// "Seq_Frame0012_NAME".
std::string frame_field(std::size_t frame, const std::string& name);

}  // namespace wobblebench::bench
