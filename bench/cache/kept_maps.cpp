#include "bench/cache/kept_maps.h"

#include <map>
#include <optional>
#include <utility>

#include "sim/tissue/tissue_map.h"

namespace wobblebench::bench {

namespace {

struct Maps {
  std::optional<phantoms::Phantom> of;
  std::map<double, std::shared_ptr<const sim::TissueMap>> by_reach_m;
};

}  // namespace

sim::TissueMapSource kept_maps(sim::TissueMapSource maps) {
  const auto kept = std::make_shared<Maps>();
  return [kept, maps = std::move(maps)](
             const phantoms::Phantom& phantom, double reach_m, int threads) {
    // Copies of a phantom share its grids.
    if (!kept->of || &kept->of->grids() != &phantom.grids()) *kept = {phantom, {}};
    auto& map = kept->by_reach_m[reach_m];
    if (!map) {
      map = maps ? maps(phantom, reach_m, threads)
                 : std::make_shared<const sim::TissueMap>(phantom, reach_m, threads);
    }
    return map;
  };
}

}  // namespace wobblebench::bench
