// Which files are of other programs.
#pragma once

#include <filesystem>

namespace wobblebench::bench {

/// `numpy`, `dicom`: known, and not read as scans.
enum class ForeignFormat { none, meta_image, nrrd, raw, kretz, zea, numpy, dicom };

/// By a file's first bytes, else by its name. `none`: a recording of ours, as far as they say. What
/// is no regular file, as a FIFO, is not opened.
ForeignFormat foreign_format(const std::filesystem::path& path);

/// "(.mha, …)", for refusals.
inline constexpr const char* kForeignNames = ".mha, .mhd, .nrrd, .nhdr, .vol, .hdf5, .raw, .img";

}  // namespace wobblebench::bench
