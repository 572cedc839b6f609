// Which files are of other programs, by their names.
#pragma once

#include <filesystem>

namespace wobblebench::bench {

enum class ForeignFormat { none, meta_image, nrrd, raw, kretz, zea };

/// `none`: a recording of ours, as far as the name says.
inline ForeignFormat foreign_format(const std::filesystem::path& path) {
  const auto extension = path.extension();
  if (extension == ".mha") return ForeignFormat::meta_image;
  if (extension == ".nrrd") return ForeignFormat::nrrd;
  if (extension == ".raw" || extension == ".img") return ForeignFormat::raw;
  if (extension == ".vol") return ForeignFormat::kretz;
  if (extension == ".hdf5" || extension == ".h5") return ForeignFormat::zea;
  return ForeignFormat::none;
}

}  // namespace wobblebench::bench
