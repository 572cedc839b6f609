// GE/Kretz volumes (.vol), as public readers of the format decode them (docs/references.md [26]).
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "bench/exchange/files/voxel_file.h"

namespace wobblebench::bench {

/// Sample i of a stick lies at first_m + i · resolution_m from the centre of curvature; the motor's
/// axis at axis_m from it, along the middle stick (hw::ProbeGeometry::axis_z_m()).
struct KretzScan {
  VoxelFile file;  ///< sample, line, frame, of 8 bits
  double resolution_m = 0;
  double first_m = 0;
  double axis_m = 0;
  std::vector<double> line_rad;   ///< from the middle of the sector
  std::vector<double> frame_rad;  ///< from the middle of the fan
};

/// Reads the items of a file. Throws UserError "PATH: …" for what is no such file, has its voxels
/// compressed, or lacks what places them.
KretzScan read_kretz(const std::filesystem::path& path);

/// All of a file up to its voxels, which follow. `source`: marks it, as the patient's name.
std::string kretz_text(const KretzScan& scan, const std::string& source);

}  // namespace wobblebench::bench
