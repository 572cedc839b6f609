#include "bench/cache/phantom_cache.h"

#include "base/byte_stream.h"
#include "bench/cache/phantom_key.h"
#include "phantoms/io/phantom_bytes.h"
#include "sim/tissue/tissue_map.h"

namespace wobblebench::bench {

namespace {

/// What `read` makes of the blob of a key; nullopt where there is none, or it is no such thing.
template <class Read>
auto load(const BlobCache& blobs, const std::string& key, const Read& read)
    -> std::optional<decltype(read(std::string_view()))> {
  const auto blob = blobs.load(key);
  if (!blob) return std::nullopt;
  try {
    return read(blob->bytes());
  } catch (const DamagedBytes&) {
    return std::nullopt;
  }
}

}  // namespace

phantoms::Phantom PhantomCache::phantom(const phantoms::PhantomOptions& options) {
  kept_ = {};
  key_.clear();
  if (!blobs_) return phantoms::make_phantom(options);
  phantoms::validate(options);
  key_ = phantom_key(options);
  if (key_.empty()) return phantoms::make_phantom(options);
  if (auto found = load(*blobs_, key_, phantoms::phantom_from_bytes)) {
    kept_.phantom = true;
    return *std::move(found);
  }
  phantoms::Phantom made = phantoms::make_phantom(options);
  // A file that changed meanwhile may have been read as it was before or after.
  if (phantom_key(options) != key_) key_.clear();
  if (key_.empty()) return made;
  if (const auto bytes = phantoms::to_bytes(made)) blobs_->store(key_, *bytes);
  return made;
}

std::shared_ptr<const sim::TissueMap> PhantomCache::tissue_map(const phantoms::Phantom& phantom,
                                                               double reach_m,
                                                               int threads) {
  kept_.tissue_map = false;
  const auto make = [&] {
    return std::make_shared<const sim::TissueMap>(phantom, reach_m, threads);
  };
  if (!blobs_ || key_.empty()) return make();
  const std::string key = tissue_map_key(key_, reach_m);
  const auto read = [&](std::string_view bytes) {
    return sim::tissue_map_from_bytes(bytes, phantom.surfaces().size(), phantom.materials().size());
  };
  if (auto found = load(*blobs_, key, read)) {
    kept_.tissue_map = true;
    return *std::move(found);
  }
  auto made = make();
  blobs_->store(key, sim::to_bytes(*made));
  return made;
}

sim::TissueMapSource PhantomCache::tissue_maps() {
  return [this](const phantoms::Phantom& phantom, double reach_m, int threads) {
    return tissue_map(phantom, reach_m, threads);
  };
}

std::optional<std::string> PhantomCache::text(const std::string& key) const {
  if (!blobs_) return std::nullopt;
  const auto blob = blobs_->load(key);
  return blob ? std::optional(std::string(blob->bytes())) : std::nullopt;
}

void PhantomCache::keep_text(const std::string& key, const std::string& text) const {
  if (blobs_) blobs_->store(key, text);
}

PhantomCache open_phantom_cache(int megabytes) {
  const auto folder = default_cache_folder();
  if (!folder || megabytes <= 0) return PhantomCache{};
  return PhantomCache(
      BlobCache(*folder, std::uint64_t{1000000} * static_cast<unsigned>(megabytes)));
}

}  // namespace wobblebench::bench
