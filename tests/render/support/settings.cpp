#include "tests/render/support/settings.h"

#include <algorithm>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <string_view>
#include <utility>
#include <vector>

#include "base/options.h"

namespace wobblebench::render::testing {

namespace {

/// The visitor that gives one key its value.
class OneSetting {
 public:
  OneSetting(std::string key, std::string value) : key_(std::move(key)), value_(std::move(value)) {}

  void real(std::string_view key, double& value, double unit, double, double) {
    if (is(key)) value = numbers(unit).at(0);
  }
  void real_or_auto(
      std::string_view key, std::optional<double>& value, double unit, double, double) {
    if (is(key)) value = value_ == kAuto ? std::nullopt : std::optional(numbers(unit).at(0));
  }
  void reals(std::string_view key, std::vector<double>& values, double unit, double, double) {
    if (is(key)) values = numbers(unit);
  }
  void vec3(std::string_view key, glm::dvec3& values, double unit, double, double) {
    if (!is(key)) return;
    const std::vector<double> given = numbers(unit);
    values = {given.at(0), given.at(1), given.at(2)};
  }
  void integer(std::string_view key, int& value, int, int) {
    if (is(key)) value = std::stoi(value_);
  }
  void flag(std::string_view key, bool& value) {
    if (is(key)) value = value_ == "true";
  }
  template <class Enum>
  void choice(std::string_view key,
              Enum& value,
              std::initializer_list<std::pair<std::string_view, Enum>> names) {
    if (!is(key)) return;
    const auto named = std::ranges::find(names, value_, &std::pair<std::string_view, Enum>::first);
    found_ = named != names.end();
    if (found_) value = named->second;
  }
  bool found() const { return found_; }

 private:
  bool is(std::string_view key) {
    found_ = found_ || key == key_;
    return key == key_;
  }
  std::vector<double> numbers(double unit) const {
    std::vector<double> found;
    std::istringstream list(value_);
    for (std::string one; std::getline(list, one, ',');) found.push_back(unit * std::stod(one));
    return found;
  }

  std::string key_, value_;
  bool found_ = false;
};

}  // namespace

void set(RenderOptions& options, const std::string& settings) {
  std::istringstream words(settings);
  for (std::string word; words >> word;) {
    const auto dot = word.find('.'), equals = word.find('=');
    const std::string section = word.substr(0, dot);
    OneSetting one(word.substr(dot + 1, equals - dot - 1), word.substr(equals + 1));
    if (section == "pipeline") describe(options.pipeline, one);
    if (section == "reconstruction") describe(options.reconstruction, one);
    if (section == "scan_conversion") describe(options.scan_conversion, one);
    if (section == "volume_of_interest") describe(options.volume_of_interest, one);
    if (section == "view") describe(options.view, one);
    if (section == "ray_casting") describe(options.ray_casting, one);
    if (section == "shading") describe(options.shading, one);
    if (section == "smoothing") describe(options.smoothing, one);
    if (!one.found()) throw std::invalid_argument(word + ": no such setting");
  }
}

}  // namespace wobblebench::render::testing
