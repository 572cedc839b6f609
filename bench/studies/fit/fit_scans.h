// Scans and pictures for the studies of `fit`.
#pragma once

#include <memory>

#include "bench/cache/phantom_cache.h"
#include "bench/evaluation/truth/truth.h"
#include "bench/pipeline/acquire.h"
#include "bench/scene/resolved_scene.h"
#include "render/renderer.h"

namespace wobblebench::bench {

/// Pictures of `fit` are at most so wide: their errors are correlated over more than a pixel.
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

/// The picture of a volume whose frames the renderer takes for those of its own plan.
render::Picture render_frames(render::Renderer& renderer, const hw::PolarVolume& volume);

}  // namespace wobblebench::bench
