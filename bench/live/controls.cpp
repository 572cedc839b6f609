#include "bench/live/controls.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string_view>
#include <vector>

#include "base/user_error.h"

namespace wobblebench::bench {

namespace {

using Json = nlohmann::ordered_json;

class ControlWriter {
 public:
  explicit ControlWriter(bool with_names) : with_names_(with_names) {}

  void real(std::string_view key, double, double, double min, double max) {
    add(key, "number", {{"min", min}, {"max", max}});
  }
  void real_or_auto(
      std::string_view key, const std::optional<double>&, double, double min, double max) {
    add(key, "number", {{"min", min}, {"max", max}, {"word", kAuto}});
  }
  void reals(std::string_view key, const std::vector<double>&, double, double min, double max) {
    add(key, "list", {{"min", min}, {"max", max}});
  }
  void vec3(std::string_view key, const glm::dvec3&, double, double min, double max) {
    add(key, "list", {{"min", min}, {"max", max}, {"length", 3}});
  }
  void integer(std::string_view key, int, int min, int max) {
    add(key, "integer", {{"min", min}, {"max", max}});
  }
  void seed(std::string_view key, std::uint64_t) {
    // The largest whole number that a page's script holds exactly.
    add(key, "integer", {{"min", 0}, {"max", 9007199254740991}});
  }
  void flag(std::string_view key, bool) { add(key, "flag", Json::object()); }
  void text(std::string_view key, const std::string&) {
    if (with_names_ && key == "name") add(key, "choice", {{"names", phantoms::phantom_names()}});
  }
  void texts(std::string_view, const std::vector<std::string>&) {}
  void constant(std::string_view, std::string_view) {}
  template <class Enum>
  void choice(std::string_view key,
              Enum,
              std::initializer_list<std::pair<std::string_view, Enum>> names) {
    Json list = Json::array();
    for (const auto& [name, value] : names) list.push_back(name);
    add(key, "choice", {{"names", std::move(list)}});
  }
  const Json& json() const { return controls_; }

 private:
  void add(std::string_view key, std::string_view kind, const Json& limits) {
    Json control = {{"key", key}, {"kind", kind}};
    control.update(limits);
    controls_.push_back(std::move(control));
  }

  bool with_names_;
  Json controls_ = Json::array();
};

bool is_of_renderer(const std::string& section) {
  return section == "render" || section.starts_with("render.");
}

}  // namespace

nlohmann::ordered_json controls_json(const Scene& scene, bool with_scan) {
  Json sections = Json::array();
  const auto add = [&](const std::string& section, const auto& options) {
    if (!with_scan && !is_of_renderer(section)) return;
    ControlWriter writer(section == "phantom");
    describe(options, writer);
    Json controls = writer.json();
    // Beside the preset the section holds what other programs than ours are given.
    if (section == "render") controls.erase(controls.begin() + 1, controls.end());
    sections.push_back({{"section", section}, {"controls", std::move(controls)}});
  };
  for_each_section(scene, add);
  return sections;
}

void check_control(const std::string& setting, bool with_scan) {
  static const Json all = controls_json({}, true), renderer = controls_json({}, false);
  const std::string key = setting.substr(0, setting.find('='));
  const auto has = [&](const Json& section) {
    return std::ranges::any_of(section["controls"], [&](const Json& control) {
      return section["section"].get<std::string>() + "." + control["key"].get<std::string>() == key;
    });
  };
  if (std::ranges::any_of(with_scan ? all : renderer, has)) return;
  throw UserError("--set " + setting + ": cannot be set on the live page");
}

}  // namespace wobblebench::bench
