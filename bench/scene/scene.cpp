#include "bench/scene/scene.h"

#include <cstdint>
#include <cstdlib>
#include <glm/vec3.hpp>
#include <initializer_list>
#include <iomanip>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace wobblebench::bench {

namespace {

/// Writes one section with the values in the units of their keys.
class JsonWriter {
 public:
  void real(std::string_view key, const double& value, double unit, double, double) {
    json_[std::string(key)] = in_unit(value, unit);
  }
  void integer(std::string_view key, const int& value, int, int) {
    json_[std::string(key)] = value;
  }
  void seed(std::string_view key, const std::uint64_t& value) { json_[std::string(key)] = value; }
  void flag(std::string_view key, const bool& value) { json_[std::string(key)] = value; }
  void text(std::string_view key, const std::string& value) { json_[std::string(key)] = value; }
  void texts(std::string_view key, const std::vector<std::string>& values) {
    json_[std::string(key)] = values;
  }
  void constant(std::string_view key, std::string_view text) { json_[std::string(key)] = text; }
  template <class Enum>
  void choice(std::string_view key,
              const Enum& value,
              std::initializer_list<std::pair<std::string_view, Enum>> names) {
    for (const auto& [name, candidate] : names) {
      if (candidate == value) json_[std::string(key)] = name;
    }
  }
  void reals(std::string_view key, const std::vector<double>& values, double unit, double, double) {
    auto& list = json_[std::string(key)] = nlohmann::ordered_json::array();
    for (const double value : values) list.push_back(in_unit(value, unit));
  }
  void vec3(std::string_view key, const glm::dvec3& value, double unit, double min, double max) {
    reals(key, {value.x, value.y, value.z}, unit, min, max);
  }
  const nlohmann::ordered_json& json() const { return json_; }

 private:
  /// Twelve digits: 0.16 m reads 160 mm, not 159.99999999999997.
  static double in_unit(double value, double unit) {
    std::ostringstream rounded;
    rounded << std::setprecision(12) << value / unit;
    return std::strtod(rounded.str().c_str(), nullptr);  // unlike std::stod, takes denormal numbers
  }
  nlohmann::ordered_json json_;
};

}  // namespace

phantoms::Placement to_placement(const PlacementOptions& options) {
  return {phantoms::rotation_xyz(options.rotation_rad), options.position_m};
}

bool Scene::moves() const {
  // As if the phantom had a joint and a mouth of any size: whether it does is not known yet.
  phantoms::Joint joint;
  joint.mouth = phantoms::Mouth{.opening_m = 1, .reach_m = 1};
  return !phantoms::Motion(motion, joint).still();
}

nlohmann::ordered_json resolved(const Scene& scene) {
  nlohmann::ordered_json json;
  for_each_section(scene, [&](const std::string& section, const auto& options) {
    JsonWriter writer;
    describe(options, writer);
    const auto dot = section.find('.');
    auto& entry = dot == std::string::npos ? json[section]
                                           : json[section.substr(0, dot)][section.substr(dot + 1)];
    entry = writer.json();
  });
  return json;
}

}  // namespace wobblebench::bench
