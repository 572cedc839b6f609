// DICOM Enhanced US Volumes, by dcmdata of DCMTK in a library of its own, which is loaded when the
// first one is written.
#pragma once

#include <cstdint>
#include <filesystem>
#include <glm/vec3.hpp>
#include <string>
#include <vector>

namespace wobblebench::bench {

/// One grid of 8 bits in the probe frame, which is the file's Volume Frame of Reference.
struct DicomVolume {
  std::uint16_t columns = 0, rows = 0;
  std::uint32_t planes = 0;
  double spacing_mm = 1;
  glm::dvec3 origin_mm{0};  ///< of the first voxel's centre; columns along x, rows along y
  double face_mm = 0;       ///< z of the middle of the probe's face
  double depth_mm = 0;      ///< of the scan
  double focus_mm = 0;      ///< depth of the transmit focus; 0: not known
  double duration_ms = 0;   ///< of the volume's acquisition; 0: not known
  std::string patient;      ///< "SIMULATED^WOBBLEBENCH": what the file is marked as
  std::string description;
  std::string version;               ///< of this program
  std::string uid_root;              ///< of the identifiers, which the content decides
  std::vector<std::uint8_t> voxels;  ///< [plane][row][column]
};

/// Writes a new file. Throws std::runtime_error "PATH: …", also where this build has no DCMTK.
void write_dicom_volume(const std::filesystem::path& path, const DicomVolume& volume);

}  // namespace wobblebench::bench
