#include "bench/exchange/input/geometry.h"

#include <algorithm>
#include <cstdint>

#include "base/near_name.h"
#include "base/user_error.h"
#include "bench/scene/toml_file.h"

namespace wobblebench::bench {

namespace {

/// Of a table, which is left without the keys that were read.
Geometry geometry_of(toml::table& table, const std::string& source) {
  Geometry geometry;
  TomlReader reader(source, "geometry", table);
  describe(geometry, reader);
  if (!table.empty()) {
    const std::string key(table.begin()->first.str());
    throw UserError(source + ": geometry." + key + ": no such key" +
                    did_you_mean(key, reader.known_keys()));
  }
  try {
    check_options(geometry, "geometry.");
  } catch (const InvalidOption& error) {
    throw UserError(source + ": " + error.what());
  }
  constexpr std::string_view kSection = "geometry.";
  for (const std::string& key : reader.given_keys()) {
    geometry.given.insert(key.substr(kSection.size()));
  }
  return geometry;
}

}  // namespace

Geometry read_geometry(const std::filesystem::path& path) {
  toml::table file = parse_toml_file(path, "a geometry");
  toml::table* table = file["geometry"].as_table();
  if (table == nullptr || file.size() != 1) {
    throw UserError(path.string() + ": must have one section, [geometry]");
  }
  return geometry_of(*table, path.string());
}

Geometry geometry_of_fields(const std::filesystem::path& path, const HeaderFields& fields) {
  constexpr std::string_view kPrefix = "wobblebench_";
  static const std::set<std::string> numbers = {"radius_mm",
                                                "wobble_radius_mm",
                                                "sector_deg",
                                                "fan_deg",
                                                "depth_mm",
                                                "dynamic_range_db",
                                                "full_scale_db",
                                                "tgc_db_per_cm_mhz",
                                                "center_frequency_mhz",
                                                "fractional_bandwidth",
                                                "f_number",
                                                "transmit_focus_mm",
                                                "elements",
                                                "pitch_mm",
                                                "element_height_mm",
                                                "elevation_focus_mm",
                                                "frames_per_volume",
                                                "lines",
                                                "samples",
                                                "frames",
                                                "white"};
  toml::table table;
  for (const auto& [name, value] : fields) {
    if (!name.starts_with(kPrefix)) continue;
    const std::string key = name.substr(kPrefix.size());
    if (key == "content") table.insert("layout", value);
    if (key == "center_px") {
      const auto center = numbers_in(path, name, value, 2);
      table.insert(key, toml::array{center[0], center[1]});
    }
    if (!numbers.contains(key)) continue;
    const double number = numbers_in(path, name, value, 1)[0];
    if (key.starts_with("frames") || key == "lines" || key == "samples" || key == "elements") {
      table.insert(key, static_cast<std::int64_t>(std::clamp(number, -1e9, 1e9)));
    } else {
      table.insert(key, number);
    }
  }
  return geometry_of(table, path.string());
}

}  // namespace wobblebench::bench
