#include "bench/pipeline/stick_sources.h"

#include <utility>

#include "bench/scene/subject_hash.h"
#include "phantoms/phantom.h"

namespace wobblebench::bench {

SimulatedScan simulated_scan(Scene scene, PhantomCache cache) {
  const auto phantom = cache.phantom(scene.phantom);
  complete_from_phantom(scene, phantom);
  return {{scene.place(phantom), scene.plan(), scene.simulation, cache.tissue_maps()},
          subject_hash(scene)};
}

MakeSticks simulated_sticks(SimulatedScan scan, std::shared_ptr<IqFile> iq) {
  return [scan = std::move(scan), iq = std::move(iq)] {
    sim::IqSink write;
    if (iq) write = [iq](const hw::StickIndex& index, auto samples) { iq->write(index, samples); };
    return sim::stick_source(scan.simulator, scan.subject, write);
  };
}

}  // namespace wobblebench::bench
