#include "bench/exchange/files/dicom_volume.h"

#include "bench/output/loaded_library.h"

namespace wobblebench::bench {

void write_dicom_volume(const std::filesystem::path& path, const DicomVolume& volume) {
  using Write = void(const std::filesystem::path&, const DicomVolume&);
  static auto* const write = reinterpret_cast<Write*>(
      function_of_library("wobblebench_dicom", "wobblebench_write_dicom", "no DICOM files"));
  write(path, volume);
}

}  // namespace wobblebench::bench
