// A stream of a simulated scene in real time on this machine, for its times.
#pragma once

#include <string>

#include "bench/cache/phantom_cache.h"
#include "bench/pipeline/stream/stream.h"
#include "bench/scene/scene.h"
#include "render/gl/context.h"

namespace wobblebench::bench {

/// The first volumes warm caches up; they are left out of records and spans.
inline constexpr std::uint32_t kWarmUpVolumes = 2;

struct WallSetting {
  Scene scene;  ///< volumes and all
  QueueOptions queue;
  std::string faults;  ///< as --board takes them; empty: none
};

/// Streams all volumes through the board, the queue and the renderer; pictures go nowhere. Throws
/// what they throw, and std::runtime_error where the stream breaks off.
StreamResult run_wall_stream(const WallSetting& setting,
                             render::GlContext& context,
                             PhantomCache& cache);

}  // namespace wobblebench::bench
