// Memory that a scene needs: options may each be in range and together need terabytes.
#pragma once

#include <filesystem>
#include <string>

#include "bench/scene/scene.h"

namespace wobblebench::bench {

/// The machine's physical memory, or the limit of the process's control group where that is less
/// (cgroup v1 and v2, and those above it). `root`: of the file system, for tests.
double available_memory_bytes(const std::filesystem::path& root = "/");

/// Peak bytes of each part, estimated before any of them is made.
struct MemoryNeed {
  double phantom = 0;       ///< its level sets while they are built; of a file: 0, not known yet
  double registration = 0;  ///< bands widened about the targets within the volume of interest
  double acquisition = 0;   ///< IQ and power of the sampled beams, then samples in transit
  double slices = 0;        ///< the slices of pass 1, and the polar volume
  double pictures = 0;      ///< pictures and textures of passes 2 to 4

  /// Peak of `wobblebench run`, which keeps the phantom throughout.
  double of_run() const;
};
MemoryNeed memory_need(const Scene& scene);

/// Throws UserError "SOURCE: keys and values: need about N GB of memory; there are M GB" if a part
/// needs more than `available_bytes`. Registration is not checked: not every command registers.
void check_memory(const Scene& scene, const std::string& source, double available_bytes);

/// Likewise for all that `wobblebench run` needs together.
void check_memory_of_run(const Scene& scene, double available_bytes);

}  // namespace wobblebench::bench
