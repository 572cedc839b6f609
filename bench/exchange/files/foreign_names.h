// Which files are of other programs.
#pragma once

#include <filesystem>

namespace wobblebench::bench {

/// Those from `exr` on hold no scans that are read.
enum class ForeignFormat {
  none,
  meta_image,
  nrrd,
  raw,
  kretz,
  zea,
  exr,
  tiff,
  png,
  pfm,
  npy,
  npz,
  dicom
};

/// By a file's first bytes, else by its name. `none`: a recording of ours, as far as they say. What
/// is no regular file, as a FIFO, is not opened.
ForeignFormat foreign_format(const std::filesystem::path& path);

/// For refusals.
inline constexpr const char* kForeignNames = ".mha, .mhd, .nrrd, .nhdr, .vol, .hdf5, .raw, .img";

}  // namespace wobblebench::bench
