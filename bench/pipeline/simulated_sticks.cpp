#include "bench/pipeline/simulated_sticks.h"

#include <utility>

#include "bench/scene/resolved_scene.h"
#include "bench/scene/subject_hash.h"

namespace wobblebench::bench {

SimulatedScan simulated_scan(const Scene& given, PhantomCache cache) {
  const ResolvedScene scene = resolve_scene(given, cache.phantom(given.phantom));
  return {{scene.subject().value(), scene.plan(), scene.simulation(), cache.tissue_maps()},
          subject_hash(scene.options())};
}

MakeSticks simulated_sticks(SimulatedScan scan, std::shared_ptr<IqFile> iq) {
  return [scan = std::move(scan), iq = std::move(iq)] {
    sim::StickSource source = sim::stick_source(scan.simulator, scan.subject);
    if (iq) {
      source.volume = [simulator = scan.simulator, iq](std::uint32_t volume) {
        return simulator.volume(
            volume, [&](const hw::StickIndex& index, auto samples) { iq->write(index, samples); });
      };
    }
    return source;
  };
}

}  // namespace wobblebench::bench
