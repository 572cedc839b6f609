// Memory that a scene needs: options may each be in range and together need terabytes.
#pragma once

#include <string>

#include "bench/scene/scene.h"

namespace wobblebench::bench {

/// Peak bytes of the largest arrays in the two stages that need most.
struct MemoryNeed {
  double acquisition = 0;  ///< IQ and power of the sampled beams, then samples in transit
  double slices = 0;       ///< the slices of pass 1, and the polar volume
};
MemoryNeed memory_need(const Scene& scene);

/// The machine's physical memory.
double machine_memory_bytes();

/// Throws UserError "SOURCE: keys and values: need N GB …" if a stage needs more than
/// `available_bytes`.
void check_memory(const Scene& scene, const std::string& source, double available_bytes);

}  // namespace wobblebench::bench
