#include "bench/pipeline/simulated_sticks.h"

#include "bench/scene/subject_hash.h"
#include "phantoms/phantom.h"

namespace wobblebench::bench {

MakeSticks simulated_sticks(Scene scene, PhantomCache cache) {
  const auto phantom = cache.phantom(scene.phantom);
  complete_from_phantom(scene, phantom);
  const sim::ProbeSimulator simulator(
      scene.place(phantom), scene.plan(), scene.simulation, cache.tissue_maps());
  return
      [simulator, subject = subject_hash(scene)] { return sim::stick_source(simulator, subject); };
}

}  // namespace wobblebench::bench
