#include "bench/studies/extremes/extreme_cases.h"

#include <algorithm>
#include <random>
#include <utility>

#include "base/number_text.h"
#include "bench/scene/scene.h"

namespace wobblebench::bench {

namespace {

constexpr auto kRefuse = MustHappen::refuse;

const std::string kScan = "acquisition.", kRays = "render.ray_casting.",
                  kShading = "render.shading.", kView = "render.view.",
                  kSlices = "render.scan_conversion.", kNoise = "simulation.noise_db=";

/// One ray of 4096 steps a millimetre through a scan of this depth, to the ball's far side.
std::vector<std::string> long_rays(const std::string& depth_mm) {
  return {kRays + "image_size=1",
          kRays + "steps=4096",
          kRays + "stop_at_box=false",
          kRays + "mode=surface",
          kRays + "buffer_length=64",
          kRays + "threshold=0.01",
          kRays + "edge=falling",
          kScan + "depth_mm=" + depth_mm,
          "render.volume_of_interest.center_mm=[0,0,41]",
          "render.volume_of_interest.size_mm=[1,1,1]"};
}

std::vector<ExtremeCase> scans() {
  const std::string sector = kScan + "sector_deg=", fan = kScan + "fan_deg=",
                    depth = kScan + "depth_mm=", speed = kScan + "sound_speed_m_s=";
  const std::string odd = kRays + "image_size=21";  // one column of pixels on the axis
  return {
      {"defaults", {}},
      {"mode plain", {"render.pipeline.mode=plain"}},
      {"sector 0.1 deg", {sector + "0.1", odd}},
      {"sector 170 deg", {sector + "170"}},
      {"sector below", {sector + "0.09"}, kRefuse},
      {"sector beyond", {sector + "171"}, kRefuse},
      {"fan 0.1 deg", {fan + "0.1", odd}},
      {"fan 170 deg", {fan + "170"}},
      {"fan below", {fan + "0.09"}, kRefuse},
      {"fan beyond", {fan + "171"}, kRefuse},
      {"sector and fan 0.1 deg", {sector + "0.1", fan + "0.1"}},
      {"sector and fan 170 deg", {sector + "170", fan + "170"}},
      {"wobble radius 0", {"probe.wobble_radius_mm=0"}},
      {"wobble radius a", {"probe.wobble_radius_mm=40"}},
      {"wobble radius beyond a", {"probe.wobble_radius_mm=80"}},
      {"wobble radius beyond its range", {"probe.wobble_radius_mm=200.1"}, kRefuse},
      {"depth 1 mm",
       {depth + "1",
        sector + "2",
        fan + "2",
        "render.volume_of_interest.center_mm=[0,0,40.5]",
        "render.volume_of_interest.size_mm=[1,1,1]"}},
      {"depth 400 mm", {depth + "400"}},
      {"depth below", {depth + "0.9"}, kRefuse},
      {"depth beyond", {depth + "401"}, kRefuse},
      {"1 frame", {kScan + "frames_per_volume=1"}},
      {"1 stick", {kScan + "sticks_per_frame=1"}},
      {"1 frame of 1 stick", {kScan + "frames_per_volume=1", kScan + "sticks_per_frame=1"}},
      {"2 samples", {kScan + "samples_per_stick=2"}},
      {"4096 samples", {kScan + "samples_per_stick=4096"}},
      {"1 sample", {kScan + "samples_per_stick=1"}, kRefuse},
      {"4097 samples", {kScan + "samples_per_stick=4097"}, kRefuse},
      {"sound speed below", {speed + "999"}, kRefuse},
      {"sound speed beyond", {speed + "4001"}, kRefuse},
  };
}

std::vector<ExtremeCase> pictures() {
  const std::string size = kRays + "image_size=", buffer = kRays + "buffer_length=",
                    threshold = kRays + "threshold=";
  return {
      {"image of 1 pixel", {size + "1"}},
      {"image of no pixel", {size + "0"}, kRefuse},
      {"image of 4097 pixels a side", {size + "4097"}, kRefuse},
      {"buffer 2", {buffer + "2"}},
      {"buffer 64", {buffer + "64", kRays + "steps=192"}},
      {"buffer odd", {buffer + "3"}, kRefuse},
      {"buffer beyond", {buffer + "66"}, kRefuse},
      {"buffer longer than the ray", {buffer + "64"}},
      {"threshold 0", {threshold + "0"}},
      {"threshold negative", {threshold + "-64"}},
      {"threshold never reached", {threshold + "64"}},
      {"threshold not a number", {threshold + "nan"}, kRefuse},
      {"filters wider than the image",
       {size + "8",
        kSlices + "filter_size=15",
        kShading + "depth_filter_size=15",
        "render.smoothing.filter_size=15"}},
      {"kernel along the ray wider than the ray",
       {kRays + "kernel_space=ray",
        kRays + "kernel_3d=5",
        kRays + "steps=4",
        buffer + "2",
        threshold + "0.002"}},
      {"one step", {kRays + "steps=1"}},
      {"step larger than the scanned volume",
       {kRays + "steps=1",
        "render.volume_of_interest.center_mm=[0,0,120]",
        "render.volume_of_interest.size_mm=[100,100,1000]"}},
      {"texels of 8 bits", {kSlices + "format=r8"}},
      {"texels of 32 bits", {kSlices + "format=r32f"}},
      {"running sum of 100000 steps", long_rays("30")},
  };
}

std::vector<ExtremeCase> views() {
  const std::string eye = kView + "eye_distance_mm=",
                    perspective = kView + "projection=perspective";
  const std::string directional = kShading + "light=directional",
                    light = kShading + "light_distance_mm=";
  return {
      {"rays along a slice", {kView + "pitch_deg=90"}},
      {"rays across the slices", {kView + "yaw_deg=90"}},
      {"rays along the axis of the motor", {kView + "pitch_deg=-90"}},
      {"rays from behind", {kView + "yaw_deg=180"}},
      {"rays grazing the far end",
       {kView + "yaw_deg=90", "render.volume_of_interest.center_mm=[0,0,200]"}},
      {"eye inside the volume",
       {perspective,
        eye + "20",
        kRays + "image_size=21",
        "render.volume_of_interest.center_mm=[0,0,80]",
        "render.volume_of_interest.size_mm=[100,100,60]"}},
      {"eye 1 mm before the centre", {perspective, eye + "1"}},
      {"eye at 10 m", {perspective, eye + "10000"}},
      {"light on the surface", {light + "30", kShading + "light_up_deg=0"}},
      {"light behind the surface",
       {light + "1", kShading + "light_up_deg=-89", kShading + "light_left_deg=89"}},
      {"light at 10 m", {light + "10000"}},
      {"light at infinity", {directional}},
      {"light at infinity, grazing", {directional, kShading + "light_left_deg=89"}},
  };
}

std::vector<ExtremeCase> samples() {
  std::vector<ExtremeCase> cases;
  const auto add = [&](const char* name, SampleChange change) {
    cases.push_back({name, {}, MustHappen::render, StickSource::ball, change});
  };
  add("samples all 0", SampleChange::all_zero);
  add("samples all 1", SampleChange::all_one);
  add("one sample NaN", SampleChange::one_nan);
  add("one sample +infinity", SampleChange::one_infinity);
  add("one sample -infinity", SampleChange::one_minus_infinity);
  add("one sample denormal", SampleChange::one_denormal);
  add("one sample 1e30", SampleChange::one_1e30);
  return cases;
}

/// `soft_tissue` has -45 dB: noise from there to 120 dB below.
std::vector<ExtremeCase> simulated() {
  std::vector<ExtremeCase> cases;
  const auto add = [&](const char* name, std::vector<std::string> settings) {
    settings.insert(settings.end(), {"phantom.name=sphere", "phantom.voxel_mm=2"});
    cases.push_back({name, std::move(settings), MustHappen::render, StickSource::simulated});
  };
  add("sound speed 1000 m/s", {kScan + "sound_speed_m_s=1000"});
  add("sound speed 4000 m/s", {kScan + "sound_speed_m_s=4000"});
  add("signal 0 dB above noise", {kNoise + "-45"});
  add("signal 60 dB above noise", {kNoise + "-105"});
  add("signal 120 dB above noise", {kNoise + "-165"});
  add("linear output, 20 MHz, TGC 3 dB/cm/MHz",
      {"simulation.output=linear",
       "probe.center_frequency_mhz=20",
       "simulation.tgc_db_per_cm_mhz=3"});
  return cases;
}

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
  void real_or_auto(
      std::string_view key, const std::optional<double>&, double, double min, double max) {
    add(key, {significant(min, 12), significant(max, 12), std::string(kAuto)});
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
      {"render.program_timeout_s",
       {}},  // of a renderer in a process of its own, which has no passes
      {"render.program_voxel_mm", {}},
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

const std::vector<std::string>& base_settings() {
  static const std::vector<std::string> settings = {
      kScan + "frames_per_volume=9",
      kScan + "sticks_per_frame=16",
      kScan + "samples_per_stick=64",
      kSlices + "slice_size=48",
      kRays + "image_size=20",
      kRays + "steps=48",
      "render.reconstruction.spacing_mm=8",
  };
  return settings;
}

std::vector<ExtremeCase> extreme_cases() {
  std::vector<ExtremeCase> all;
  for (const auto& part : {scans(), pictures(), views(), samples(), simulated()}) {
    all.insert(all.end(), part.begin(), part.end());
  }
  return all;
}

std::vector<ExtremeCase> long_extreme_cases() {
  const std::vector<std::string> large = {kRays + "image_size=4096"};
  return {{"image of 4096² pixels", large, MustHappen::render, StickSource::ball, {}, false},
          {"running sum of 1600000 steps", long_rays("400")}};
}

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
