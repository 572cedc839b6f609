#include "bench/pipeline/simulated_sticks.h"

#include "bench/scene/subject_hash.h"
#include "phantoms/phantom.h"

namespace wobblebench::bench {

MakeSticks simulated_sticks(Scene scene) {
  const auto phantom = phantoms::make_phantom(scene.phantom);
  complete_from_phantom(scene, phantom);
  const sim::ProbeSimulator simulator(scene.place(phantom), scene.plan(), scene.simulation);
  return
      [simulator, subject = subject_hash(scene)] { return sim::stick_source(simulator, subject); };
}

}  // namespace wobblebench::bench
