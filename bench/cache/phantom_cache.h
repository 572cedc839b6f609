// Phantoms, their tissue maps and what was measured with them, kept between runs.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "bench/cache/blob_cache.h"
#include "bench/scene/resolved_scene.h"
#include "phantoms/options.h"
#include "phantoms/phantom.h"
#include "sim/probe_simulator.h"

namespace wobblebench::bench {

/// Makes what it has not kept. Without a cache it makes everything. Not thread-safe.
class PhantomCache {
 public:
  PhantomCache() = default;
  explicit PhantomCache(std::optional<BlobCache> blobs) : blobs_(std::move(blobs)) {}

  /// Throws as make_phantom() does.
  phantoms::Phantom phantom(const phantoms::PhantomOptions& options);

  /// Maps of the phantom that phantom() gave last, as long as this lives.
  sim::TissueMapSource tissue_maps();

  /// Echoes of a scene with the phantom that phantom() gave last, as long as this lives.
  sim::EchoStore echoes(const ResolvedScene& scene);

  /// A text that was kept under this key; nullopt: none.
  std::optional<std::string> text(const std::string& key) const;
  void keep_text(const std::string& key, const std::string& text) const;

  /// Whether the last of each came from the cache.
  struct Kept {
    bool phantom = false;
    bool tissue_map = false;
    bool echoes = false;
  };
  const Kept& kept() const { return kept_; }

 private:
  std::shared_ptr<const sim::TissueMap> tissue_map(const phantoms::Phantom& phantom,
                                                   double reach_m,
                                                   int threads);

  std::optional<BlobCache> blobs_;
  std::string key_;  ///< of the last phantom; empty: it cannot be kept
  Kept kept_;
};

/// In the user's folder (default_cache_folder()); `megabytes` 0: none.
PhantomCache open_phantom_cache(int megabytes);

/// Names every option with its exact value, the content of an imported file and of a list of
/// scatterers in the place of their folders, the sources of this build, its compiler, and the
/// versions of the libraries that compute. Empty where the file cannot be read.
std::string phantom_key(const phantoms::PhantomOptions& options);

/// Keys of the tissue map of a phantom with this key, and of its echoes in a scene.
std::string tissue_map_key(const std::string& phantom, double reach_m);
std::string echoes_key(const std::string& phantom, const Scene& scene);

/// Takes the map of a phantom and a reach from `maps`, or makes it, once, and keeps it as long as
/// the result and its copies live, which any threads use: one makes a map, the others wait. Another
/// phantom's map replaces all.
sim::TissueMapSource kept_maps(sim::TissueMapSource maps);

}  // namespace wobblebench::bench
