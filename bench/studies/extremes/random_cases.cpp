// Settings at the ends of their ranges, drawn from a seed.
#include <algorithm>
#include <random>

#include "base/number_text.h"
#include "bench/scene/scene.h"
#include "bench/studies/extremes/extreme_cases.h"

namespace wobblebench::bench {

namespace {

struct Ends {
  std::string key;
  std::vector<std::string> values;
};

/// A visitor of describe() that lists the ends of each option.
class EndsOfOptions {
 public:
  std::string section;
  std::vector<Ends> found;

  void real(std::string_view key, double, double, double min, double max) {
    add(key, {significant(min, 12), significant(max, 12)});
  }
  void integer(std::string_view key, int, int min, int max) {
    add(key, {std::to_string(min), std::to_string(max)});
  }
  void flag(std::string_view key, bool) { add(key, {"false", "true"}); }
  template <class Enum>
  void choice(std::string_view key,
              Enum,
              std::initializer_list<std::pair<std::string_view, Enum>> values) {
    std::vector<std::string> names;
    for (const auto& [name, value] : values) names.emplace_back(name);
    add(key, names);
  }
  void reals(std::string_view, const std::vector<double>&, double, double, double) {}
  void vec3(std::string_view, const glm::dvec3&, double, double, double) {}
  void seed(std::string_view, std::uint64_t) {}
  void text(std::string_view, const std::string&) {}
  void texts(std::string_view, const std::vector<std::string>&) {}
  void constant(std::string_view, std::string_view) {}

 private:
  void add(std::string_view key, std::vector<std::string> values) {
    found.push_back({section + "." + std::string(key), std::move(values)});
  }
};

/// What a picture's cost grows with ends here, and what the study sets itself is left alone.
const std::vector<Ends>& replaced_ends() {
  static const std::vector<Ends> ends = {
      {"acquisition.frames_per_volume", {"1", "9"}},
      {"acquisition.sticks_per_frame", {"1", "16"}},
      {"acquisition.samples_per_stick", {"2", "4096"}},
      {"acquisition.volumes", {}},
      {"probe.preset", {}},
      {"render.preset", {}},
      {"render.reconstruction.spacing_mm", {"8", "100"}},
      {"render.pipeline.mid_volume", {}},
      {"render.scan_conversion.slice_size", {"16", "48"}},
      {"render.scan_conversion.filter_size", {"1", "15"}},
      {"render.ray_casting.image_size", {"1", "20"}},
      {"render.ray_casting.steps", {"1", "96"}},
      {"render.ray_casting.kernel_space", {"slice"}},
      {"render.ray_casting.stop_at_box", {"true"}},
  };
  return ends;
}

std::vector<Ends> ends_of_options() {
  EndsOfOptions visitor;
  const Scene scene;
  for_each_section(scene, [&](const std::string& name, const auto& options) {
    const bool drawn = name == "acquisition" || name == "probe" || name.starts_with("render");
    if (!drawn) return;
    visitor.section = name;
    describe(options, visitor);
  });
  std::vector<Ends> ends;
  for (const Ends& option : visitor.found) {
    const auto& replaced = replaced_ends();
    const auto same = std::find_if(replaced.begin(), replaced.end(), [&](const Ends& other) {
      return other.key == option.key;
    });
    ends.push_back(same == replaced.end() ? option : *same);
  }
  std::erase_if(ends, [](const Ends& option) { return option.values.empty(); });
  return ends;
}

}  // namespace

std::vector<ExtremeCase> random_extreme_cases(std::uint64_t seed, int count) {
  const std::vector<Ends> ends = ends_of_options();
  std::vector<ExtremeCase> cases;
  for (int i = 0; i < count; ++i) {
    // Raw bits of the generator: the standard's distributions differ between libraries.
    std::seed_seq words{seed & 0xffffffffU, seed >> 32, static_cast<std::uint64_t>(i)};
    std::mt19937_64 bits(words);
    ExtremeCase drawn{"random " + std::to_string(seed) + "." + std::to_string(i), {}};
    drawn.must = MustHappen::either;
    for (const Ends& option : ends) {
      if (bits() % 10 >= 3) continue;
      drawn.settings.push_back(option.key + "=" + option.values[bits() % option.values.size()]);
    }
    cases.push_back(std::move(drawn));
  }
  return cases;
}

}  // namespace wobblebench::bench
