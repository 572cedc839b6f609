#include "bench/studies/fit/fit_scans.h"

#include <algorithm>
#include <map>
#include <utility>

namespace wobblebench::bench {

LoadedPhantom load_phantom(const phantoms::PhantomOptions& options, PhantomCache& cache) {
  LoadedPhantom loaded{cache.phantom(options), {}};
  using Maps = std::map<double, std::shared_ptr<const sim::TissueMap>>;
  loaded.maps = [source = cache.tissue_maps(), kept = std::make_shared<Maps>()](
                    const phantoms::Phantom& phantom, double reach_m, int threads) {
    auto& map = (*kept)[reach_m];
    if (!map) map = source(phantom, reach_m, threads);
    return map;
  };
  return loaded;
}

ResolvedScene fit_scene(Scene scene, const phantoms::Phantom& phantom) {
  scene.picture.correction.clear();
  scene.render.ray_casting.image_size =
      std::min(scene.render.ray_casting.image_size, kFitImageSize);
  return resolve_scene(std::move(scene), phantom);
}

hw::PolarVolume scan_with_seed(const ResolvedScene& scene,
                               std::uint64_t seed,
                               const sim::TissueMapSource& maps) {
  Scene seeded = scene.options();
  seeded.simulation.seed = seed;
  return acquire_simulated(ResolvedScene(std::move(seeded), scene.subject()), maps).volume;
}

render::Picture render_frames(render::Renderer& renderer, const hw::PolarVolume& volume) {
  int index = 0;
  for (const hw::PolarFrame& frame : volume.frames()) renderer.add_frame(index++, frame);
  return renderer.render();
}

}  // namespace wobblebench::bench
