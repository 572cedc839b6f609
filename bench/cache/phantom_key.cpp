#include "bench/cache/phantom_key.h"

#include <fcntl.h>
#include <gnu/libc-version.h>
#include <openvdb/version.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "base/file_descriptor.h"
#include "bench/cache/sha256.h"
#include "phantom_sources.h"
#include "phantoms/io/phantom_bytes.h"
#include "sim/tissue/tissue_map.h"

namespace wobblebench::bench {

namespace {

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

std::optional<std::string> hash_of_file(const std::string& path) {
  const FileDescriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  if (!file.is_open()) return std::nullopt;
  Sha256 hash;
  std::array<char, 1 << 16> bytes{};
  for (;;) {
    const ssize_t count = ::read(file.get(), bytes.data(), bytes.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return std::nullopt;
    if (count == 0) return hex(hash.digest());
    hash.add({bytes.data(), static_cast<std::size_t>(count)});
  }
}

bool is_imported(const phantoms::PhantomOptions& options) {
  const auto& names = phantoms::phantom_names();
  return std::find(names.begin(), names.end(), options.name) == names.end();
}

}  // namespace

std::string phantom_key(const phantoms::PhantomOptions& options) {
  KeyWriter key;
  key.add("phantom", std::to_string(phantoms::kPhantomBytesVersion));
  key.add("sources", kPhantomSources);
  key.add("openvdb", OPENVDB_LIBRARY_VERSION_STRING);
  key.add("libc", ::gnu_get_libc_version());
  describe(options, key);
  for (const std::string& file :
       {is_imported(options) ? options.file : std::string(), options.scatterers}) {
    if (file.empty()) continue;
    const auto content = hash_of_file(file);
    if (!content) return "";
    key.add("content", *content);
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

}  // namespace wobblebench::bench
