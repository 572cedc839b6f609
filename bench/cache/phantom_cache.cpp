#include "bench/cache/phantom_cache.h"

#include <gnu/libc-version.h>
#include <openvdb/version.h>

#include <algorithm>
#include <array>
#include <complex>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <initializer_list>
#include <map>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <stdexcept>
#include <string_view>
#include <utility>
#include <vector>

#include "base/byte_stream.h"
#include "bench/cache/sha256.h"
#include "phantom_sources.h"
#include "phantoms/io/phantom_bytes.h"
#include "sim/tissue/tissue_map.h"
#include "simulator_sources.h"

namespace wobblebench::bench {

namespace {

/// What `read` makes of the blob of a key; nullopt where there is none, or it is no such thing.
template <class Read>
auto load(const BlobCache& blobs, const std::string& key, const Read& read)
    -> std::optional<decltype(read(std::string_view()))> {
  const auto blob = blobs.load(key);
  if (!blob) return std::nullopt;
  try {
    return read(std::string_view(*blob));
  } catch (const DamagedBytes&) {
    return std::nullopt;
  }
}

/// All digits of a number.
std::string exact(double value) {
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "%a", value);
  return text.data();
}

/// Visits a description (base/options.h). Each text is preceded by its length, so that no two lists
/// of options read alike.
class KeyWriter {
 public:
  void real(std::string_view key, double value, double, double, double) { add(key, exact(value)); }
  void reals(std::string_view key, const std::vector<double>& values, double, double, double) {
    add(key, std::to_string(values.size()));
    for (const double value : values) add("", exact(value));
  }
  void seed(std::string_view key, std::uint64_t value) { add(key, std::to_string(value)); }
  template <class Enum>
  void choice(std::string_view key,
              Enum value,
              std::initializer_list<std::pair<std::string_view, Enum>>) {
    add(key, std::to_string(static_cast<int>(value)));
  }
  void flag(std::string_view key, bool value) { add(key, value ? "1" : "0"); }
  void text(std::string_view key, const std::string& value) { add(key, value); }
  void texts(std::string_view key, const std::vector<std::string>& values) {
    add(key, std::to_string(values.size()));
    for (const std::string& value : values) add("", value);
  }

  void add(std::string_view key, const std::string& value) {
    text_ += std::string(key) + " " + std::to_string(value.size()) + " " + value + "\n";
  }
  std::string take() { return std::move(text_); }

 private:
  std::string text_;
};

bool is_imported(const phantoms::PhantomOptions& options) {
  const auto& names = phantoms::phantom_names();
  return std::find(names.begin(), names.end(), options.name) == names.end();
}

struct Maps {
  std::mutex mutex;  ///< of what follows
  std::optional<phantoms::Phantom> of;
  std::map<double, std::shared_ptr<const sim::TissueMap>> by_reach_m;
};

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

sim::EchoStore PhantomCache::echoes(const ResolvedScene& scene) {
  kept_.echoes = false;
  if (!blobs_ || key_.empty()) return {};
  const std::string key = echoes_key(key_, scene.options());
  const auto load_echoes = [this, key](std::span<std::complex<float>> echoes) {
    const auto blob = blobs_->load(key);
    if (!blob || blob->size() != echoes.size_bytes()) return false;
    std::memcpy(echoes.data(), blob->data(), blob->size());
    return kept_.echoes = true;
  };
  const auto keep = [this, key](std::span<const std::complex<float>> echoes) {
    blobs_->store(key, {reinterpret_cast<const char*>(echoes.data()), echoes.size_bytes()});
  };
  return {load_echoes, keep};
}

std::optional<std::string> PhantomCache::text(const std::string& key) const {
  return blobs_ ? blobs_->load(key) : std::nullopt;
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

std::string phantom_key(const phantoms::PhantomOptions& options) {
  KeyWriter key;
  key.add("phantom", std::to_string(phantoms::kPhantomBytesVersion));
  key.add("sources", kPhantomSources);
  key.add("openvdb", OPENVDB_LIBRARY_VERSION_STRING);
  key.add("libc", ::gnu_get_libc_version());
  phantoms::PhantomOptions named = options;
  // A mesh is named after its file; the folder changes nothing.
  named.file = std::filesystem::path(options.file).filename();
  named.scatterers = std::filesystem::path(options.scatterers).extension();
  describe(named, key);
  try {
    if (is_imported(options)) key.add("content", sha256_of_file(options.file));
    if (!options.scatterers.empty()) key.add("content", sha256_of_file(options.scatterers));
  } catch (const std::runtime_error&) {
    return "";
  }
  return key.take();
}

std::string tissue_map_key(const std::string& phantom, double reach_m) {
  KeyWriter key;
  key.add("phantom", phantom);
  key.add("tissue map", std::to_string(sim::kTissueMapBytesVersion));
  key.add("reach", exact(reach_m));
  return key.take();
}

std::string echoes_key(const std::string& phantom, const Scene& scene) {
  Scene scanned = scene;
  scanned.picture = {};
  scanned.render = {};
  KeyWriter key;
  key.add("phantom", phantom);
  key.add("simulator", kSimulatorSources);
  key.add("scene", resolved(scanned).dump());
  return key.take();
}

sim::TissueMapSource kept_maps(sim::TissueMapSource maps) {
  const auto kept = std::make_shared<Maps>();
  return [kept, maps = std::move(maps)](
             const phantoms::Phantom& phantom, double reach_m, int threads) {
    // Copies of a phantom share its grids.
    const std::lock_guard lock(kept->mutex);
    if (!kept->of || &kept->of->grids() != &phantom.grids()) {
      kept->of = phantom;
      kept->by_reach_m.clear();
    }
    auto& map = kept->by_reach_m[reach_m];
    if (!map) {
      map = maps ? maps(phantom, reach_m, threads)
                 : std::make_shared<const sim::TissueMap>(phantom, reach_m, threads);
    }
    return map;
  };
}

}  // namespace wobblebench::bench
