// A scan of another program, of any bytes: made a recording, or refused in one line. The input is
// the extension, a line of "---", the geometry in TOML (empty: none), a line of "---", and the
// file.
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <string_view>

#include "base/user_error.h"
#include "bench/exchange/input/foreign_scan.h"

namespace bench = wobblebench::bench;
namespace fs = std::filesystem;

namespace {

constexpr double kMostSamples = 1 << 20;  // so that an input takes no longer than its neighbours

/// A folder that goes with the process.
struct Scratch {
  Scratch() : path(fs::temp_directory_path() / "fuzz_foreign_scan_XXXXXX") {
    std::string text = path.string();
    if (::mkdtemp(text.data()) == nullptr) std::abort();
    path = text;
  }
  ~Scratch() { fs::remove_all(path); }
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;

  fs::path holding(const std::string& name, std::string_view bytes) const {
    std::ofstream(path / name, std::ios::binary)
        .write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    return path / name;
  }

  fs::path path;
};

/// What stands before the next mark, which is taken from `rest`.
std::optional<std::string_view> next_part(std::string_view& rest) {
  constexpr std::string_view mark = "---\n";
  const std::size_t at = rest.find(mark);
  if (at == std::string_view::npos) return {};
  const std::string_view part = rest.substr(0, at);
  rest.remove_prefix(at + mark.size());
  return part;
}

void check(const fs::path& file, const fs::path& geometry) {
  const bench::ForeignScan scan = bench::open_foreign_scan(file, geometry);
  const auto& acquisition = scan.plan.acquisition();
  if (scan.motor_rad.size() != static_cast<std::size_t>(acquisition.frames_per_volume)) {
    std::abort();
  }
  const double samples =
      1.0 * acquisition.volumes * scan.plan.sticks_per_volume() * acquisition.samples_per_stick;
  if (samples > kMostSamples) return;
  for (const float sample : scan.samples(0, {})) {
    if (!std::isfinite(sample) || sample < 0) std::abort();
  }
  bench::recorded(scan);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const Scratch scratch;
  std::string_view rest(reinterpret_cast<const char*>(data), size);
  const auto format = next_part(rest);
  const auto geometry = next_part(rest);
  if (!format || !geometry) return -1;
  const std::string extension =
      *format == "nrrd" || *format == "vol" || *format == "raw" ? std::string(*format) : "mha";
  const fs::path file = scratch.holding("scan." + extension, rest);
  const fs::path toml =
      geometry->empty() ? fs::path() : scratch.holding("geometry.toml", *geometry);
  try {
    check(file, toml);
  } catch (const wobblebench::UserError& error) {
    if (std::string_view(error.what()).find('\n') != std::string_view::npos) std::abort();
  }
  return 0;
}
