#include "tests/bench/cli/wrong_values.h"

#include <cmath>
#include <cstdint>
#include <glm/vec3.hpp>
#include <initializer_list>
#include <string_view>
#include <utility>

#include "bench/scene/scene.h"
#include "hw/link/xdma_link.h"
#include "hw/recording/file_link.h"
#include "sim/card/sim_link.h"
#include "tests/support/expect.h"

namespace wobblebench::bench::testing {

namespace {

/// Beyond [min, max], by more than a rounding.
std::vector<std::string> out_of_range(double min, double max) {
  const double beyond = 1 + 0.01 * (std::abs(min) + std::abs(max));
  std::vector<std::string> values = {"nan"};
  if (std::isfinite(max)) values.insert(values.end(), {std::to_string(max + beyond), "inf"});
  if (std::isfinite(min)) values.insert(values.end(), {std::to_string(min - beyond), "-inf"});
  return values;
}

/// The visitor that collects "key=value" with wrong values; `in_toml`: as a scene reads them.
class WrongValues {
 public:
  explicit WrongValues(bool in_toml) : in_toml_(in_toml) {}

  void real(std::string_view key, double&, double, double min, double max) {
    add(key, out_of_range(min, max));
    add(key, {"", "many", "1,5", "0x"});
    if (in_toml_) add(key, {"[1]", "true", "{}", "1979-05-27", "1e999999"});
  }
  void real_or_auto(
      std::string_view key, std::optional<double>&, double unit, double min, double max) {
    double number = 0;
    real(key, number, unit, min, max);
  }
  void reals(std::string_view key, std::vector<double>&, double, double min, double max) {
    for (const auto& value : out_of_range(min, max)) add(key, {"[" + value + "]"});
    add(key, {"5", "", "[\"x\"]", "[[1]]", "[1"});
  }
  void vec3(std::string_view key, glm::dvec3&, double, double min, double max) {
    for (const auto& value : out_of_range(min, max)) add(key, {"[0, " + value + ", 0]"});
    add(key, {"5", "", "[]", "[1, 2]", "[1, 2, 3, 4]", "[1, 2, \"x\"]"});
  }
  void integer(std::string_view key, int&, int min, int max) {
    add(key, {std::to_string(std::int64_t{min} - 1), std::to_string(std::int64_t{max} + 1)});
    add(key, {"", "1.5", "nan", "99999999999999999999999", "4294967297999", "many", "1 2"});
  }
  void seed(std::string_view key, std::uint64_t&) {
    add(key, {"-1", "1.5", "", "99999999999999999999999", "seven"});
  }
  void flag(std::string_view key, bool&) { add(key, {"yes", "2", "", "True"}); }
  void text(std::string_view key, std::string&) {
    if (in_toml_) add(key, {"5", "[]", "true", "[\"x\"]"});
  }
  void texts(std::string_view key, std::vector<std::string>&) {
    add(key, {"5", "[1]", "x", "", "true"});
  }
  void constant(std::string_view key, std::string_view) { add(key, {"5", "another", ""}); }
  template <class Enum>
  void choice(std::string_view key,
              Enum&,
              std::initializer_list<std::pair<std::string_view, Enum>>) {
    add(key, {"no_such_choice", "", "nan"});
  }

  const std::vector<std::string>& settings() const { return settings_; }
  const std::vector<std::string>& keys() const { return keys_; }

 private:
  void add(std::string_view key, const std::vector<std::string>& values) {
    keys_.emplace_back(key);
    for (const auto& value : values) settings_.push_back(std::string(key) + "=" + value);
  }

  bool in_toml_;
  std::vector<std::string> settings_;
  std::vector<std::string> keys_;
};

template <class Options>
void add_wrong_links(const std::string& link, std::vector<std::string>& boards) {
  Options options;
  WrongValues wrong(false);
  describe(options, wrong);
  for (const auto& setting : wrong.settings()) boards.push_back(link + "," + setting);
  const std::string& key = wrong.keys().front();
  for (const std::string& rest : {key, "=" + key, std::string("no_such_key=1"), std::string()}) {
    boards.push_back(link + "," + rest + ",no_such_key=1");
  }
}

}  // namespace

std::vector<std::string> wrong_settings() {
  std::vector<std::string> all = words_of(
      "= . =1 a .= ..=1 a=1 .a=1 phantom.=1 .phantom.voxel_mm=1 phantom..voxel_mm=1 "
      "phantom.voxel_mm..=1 phantom.voxel_mm phantom=1 render=1 render.view=1 "
      "render.view.yaw_deg.x=1 phantom.name=\x01 phantom.file=\xff.vdb \xff.\xfe=1 "
      "phantom.\xc0\x80=1 PHANTOM.voxel_mm=1 phantom.name=no_such_phantom "
      "probe.preset=no_such_preset");
  all.insert(
      all.end(),
      {"", "phantom.name=a\nb", "phantom .voxel_mm=1", "phantom.voxel_mm=1\nphantom.name=2"});
  Scene scene;
  for_each_section(scene, [&](const std::string& section, auto& options) {
    WrongValues wrong(true);
    describe(options, wrong);
    for (const auto& setting : wrong.settings()) all.push_back(section + "." + setting);
    all.push_back(section + ".no_such_key=1");
    all.push_back(section + "x." + wrong.keys().front() + "=1");
  });
  return all;
}

std::vector<std::string> wrong_boards() {
  std::vector<std::string> all = words_of(
      ", = nonsense SIM sim=5 file file= file=none.wbst file=folder file=whole.wbst/under "
      "xdma xdma= xdma=none xdma=folder \xff sim,\xff=1 sim,pace=asap,pace=asap "
      "file=none.wbst,loop=true");
  all.insert(all.end(), {"", "sim\n", "sim,faults="});
  for (const std::string& faults :
       words_of("drop drop: drop:2 drop:-0.1 drop:nan drop@-1 drop@x melt:0.1 drop:0.1+ + seed:-1 "
                "delay_ms:60001 stall_ms:nan")) {
    all.push_back("sim,faults=" + faults);
  }
  add_wrong_links<sim::SimLinkOptions>("sim", all);
  add_wrong_links<hw::FileLinkOptions>("file=whole.wbst", all);
  add_wrong_links<hw::XdmaLinkOptions>("xdma=none", all);
  return all;
}

}  // namespace wobblebench::bench::testing
