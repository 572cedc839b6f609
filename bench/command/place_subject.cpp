#include "bench/command/place_subject.h"

namespace wobblebench::bench {

std::optional<phantoms::PlacedPhantom> place_subject(Scene& scene,
                                                     hw::StreamOrigin source,
                                                     PhantomCache& cache,
                                                     Progress& progress) {
  if (source != hw::StreamOrigin::simulated) {
    complete_from_plan(scene);
    return {};
  }
  const auto phantom = progress.step("phantom", [&] { return cache.phantom(scene.phantom); });
  complete_from_phantom(scene, phantom);
  return scene.place(phantom);
}

}  // namespace wobblebench::bench
