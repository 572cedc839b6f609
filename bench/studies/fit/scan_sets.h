// Which scans the detection-error model is fitted to, and which it is judged on.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "bench/cache/phantom_cache.h"
#include "bench/scene/scene.h"

namespace wobblebench::bench {

/// One scene at one pose, with its seeds, each on each rung.
struct ScanSet {
  std::string name;
  std::string of;  ///< what is new about it to a model that was fitted to the training sets
  Scene scene;
  std::vector<std::uint64_t> seeds;
};

/// The scene's own rung; where it leaves the choice, `field` and `scatterers`.
std::vector<sim::Rung> rungs_of_fit(const Scene& scene);

/// The scene at three poses, in another view, with half the frames and half the sticks, and, of a
/// detector with a buffer, twice the buffer; a ball, and planes of two slopes. Each set has the
/// next `count` seeds from the scene's.
std::vector<ScanSet> training_sets(const Scene& scene, int count);
/// Folds of cross-validation over training sets: each set, and all sets of each phantom.
std::vector<std::vector<int>> folds_of(const std::vector<ScanSet>& training);

/// Seeds that no training set has. The scene with these, at another pose, half a line and half a
/// frame to the side, and in another view; steps; and the phantoms of other scenes, which were not
/// trained on. `first`: the first seed that is free.
std::vector<ScanSet> held_out_sets(const Scene& scene,
                                   const std::vector<std::pair<std::string, Scene>>& others,
                                   std::uint64_t first,
                                   PhantomCache& cache);

}  // namespace wobblebench::bench
