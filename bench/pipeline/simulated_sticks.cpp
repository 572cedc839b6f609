#include "bench/pipeline/simulated_sticks.h"

#include "phantoms/phantom.h"

namespace wobblebench::bench {

MakeSticks simulated_sticks(Scene scene) {
  const auto phantom = phantoms::make_phantom(scene.phantom);
  complete_from_phantom(scene, phantom);
  const sim::ProbeSimulator simulator(phantom,
                                      scene.phantom_placement(),
                                      scene.plan(),
                                      scene.simulation,
                                      scene.phantom_motion(phantom));
  return [simulator] { return sim::stick_source(simulator); };
}

}  // namespace wobblebench::bench
