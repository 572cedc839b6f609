// A scan in a file of another program, as the recording of hardware that it is taken for.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "base/file.h"
#include "bench/exchange/files/voxel_file.h"
#include "hw/link/link.h"
#include "hw/probe/acquisition_plan.h"
#include "hw/recording/file_link.h"
#include "hw/wire/configuration.h"

namespace wobblebench::bench {

struct ForeignScan {
  std::filesystem::path path;
  hw::AcquisitionPlan plan;        ///< with its number of volumes
  hw::DisplayScale display_scale;  ///< what of it the geometry says
  std::vector<double> motor_rad;   ///< angle of each frame
  /// Samples of a volume, [frame][line][sample], 0 to 1 over the dynamic range; of `frames` alone,
  /// unless that is empty. Throws UserError.
  std::function<std::vector<float>(std::uint32_t volume, const std::vector<bool>& frames)> samples;
  /// [volume * frames + frame]: whose sticks there are; empty: all.
  std::vector<bool> valid = {};
  std::string summary;  ///< a few lines for a terminal: what the file holds, and how it is taken
};

/// `geometry`: a file in TOML; empty: none. Reads headers, no voxels. Throws UserError "PATH: …"
/// for a file that is damaged, or does not say what is needed.
ForeignScan open_foreign_scan(const std::filesystem::path& path,
                              const std::filesystem::path& geometry);

/// The same of voxels that are described already, raw or with fields of `export`.
ForeignScan scan_of_voxels(VoxelFile file, const std::filesystem::path& geometry);

/// A volume's packets of the wire format, of hardware: its configuration, the sticks of `values`,
/// [frame][line][sample], and its end. `frames`: those that `values` are of; empty: all.
std::vector<std::byte> packets_of_volume(const ForeignScan& scan,
                                         std::uint32_t volume,
                                         const std::vector<float>& values,
                                         const std::vector<bool>& frames = {});

/// Throws UserError where its samples need more than half of the memory.
void check_memory(const ForeignScan& scan);

/// The scan as a recording in memory, in the wire format; of hardware, so that nothing compares it
/// with a truth. Throws as check_memory() and `samples`.
FileDescriptor recorded(const ForeignScan& scan);

/// Where an open descriptor can be opened once more.
std::filesystem::path descriptor_path(const FileDescriptor& file);

/// A link that plays the recording. Throws UserError, InvalidOption.
std::unique_ptr<hw::Link> open_foreign_link(const ForeignScan& scan,
                                            const hw::FileLinkOptions& options);

}  // namespace wobblebench::bench
