// What the live page draws in space: sticks of the probe and surfaces of the phantom.
#pragma once

#include "bench/live/server/live_server.h"
#include "bench/scene/resolved_scene.h"

namespace wobblebench::bench {

/// Lines of a frame, and frames, of which sticks are drawn, at most.
inline constexpr int kMostDrawnLines = 64, kMostDrawnFrames = 128;

/// Parts: sticks, [frame][line][begin, end][x, y, z]; then of each target surface its points and
/// its triangles; floats and 32-bit integers, little-endian, mm in the probe frame, the phantom as
/// it is at the stream's beginning. The header says which frames and lines, and names the surfaces.
LiveMessage space_message(const ResolvedScene& scene);

}  // namespace wobblebench::bench
