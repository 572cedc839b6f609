// The scans of `fit`: of its registrations, and those that the detection-error model is fitted to
// and judged on.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "bench/cache/phantom_cache.h"
#include "bench/pipeline/acquire.h"
#include "bench/scene/resolved_scene.h"
#include "render/renderer.h"

namespace wobblebench::bench {

/// Width of a picture of `fit` at most: errors are correlated over more than a pixel.
inline constexpr int kFitImageSize = 256;

/// A phantom with its tissue map, which is read or made once.
struct LoadedPhantom {
  phantoms::Phantom phantom;
  sim::TissueMapSource maps;
};
LoadedPhantom load_phantom(const phantoms::PhantomOptions& options, PhantomCache& cache);

/// The scene of a fit: at most kFitImageSize wide, z uncorrected, framed by the phantom.
ResolvedScene fit_scene(Scene scene, const phantoms::Phantom& phantom);

/// The volume of the scene's probe with this seed, through the board.
hw::PolarVolume scan_with_seed(const ResolvedScene& scene,
                               std::uint64_t seed,
                               const sim::TissueMapSource& maps);

/// The picture of a volume, whose frames the renderer places as its own plan has them.
render::Picture render_frames(render::Renderer& renderer, const hw::PolarVolume& volume);

/// One scene at one pose, with its seeds, each on each rung.
struct ScanSet {
  std::string name;
  std::string of;  ///< what differs from the training sets; "training" for those
  Scene scene;
  std::vector<std::uint64_t> seeds;
};

/// The scene's own rung; where it leaves the choice, `field` and `scatterers`.
std::vector<sim::Rung> rungs_of_fit(const Scene& scene);

/// The scene at three poses, in another view, with half the frames, with half the sticks and, for a
/// detector with a buffer, with twice the buffer; a ball, and planes of two slopes. Each set has
/// the next `count` seeds, the first of which is the scene's.
std::vector<ScanSet> training_sets(const Scene& scene, int count);
/// Folds of cross-validation over training sets: each set, and all sets of each phantom.
std::vector<std::vector<int>> folds_of(const std::vector<ScanSet>& training);

/// The scene with seeds that no training set has, from `first` on, the same at another pose, half a
/// line and half a frame to the side, and in another view; steps; and the phantoms of other scenes.
std::vector<ScanSet> held_out_sets(const Scene& scene,
                                   const std::vector<std::pair<std::string, Scene>>& others,
                                   std::uint64_t first,
                                   PhantomCache& cache);

}  // namespace wobblebench::bench
