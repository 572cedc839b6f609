// What a scene asks of the machine: options may each be in range and together mean terabytes.
#pragma once

#include <string>

#include "bench/scene/scene.h"

namespace wobblebench::bench {

/// Bytes held at once, by the largest arrays of the two stages that hold most.
struct MemoryNeed {
  double acquisition = 0;  ///< IQ and power of the sampled beams, then samples on their way
  double slices = 0;       ///< the stack of pass 1, and the polar volume that it is made of
};
MemoryNeed memory_need(const Scene& scene);

/// The machine's physical memory.
double machine_memory_bytes();

/// Throws UserError "SOURCE: keys and values: need N GB …" if a stage needs more than `available`.
void check_memory(const Scene& scene, const std::string& source, double available_bytes);

}  // namespace wobblebench::bench
