#include "bench/studies/validate/yardstick.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "base/units.h"

namespace wobblebench::bench {

namespace {

std::vector<std::string> fields_of(std::string_view line) {
  std::vector<std::string> fields;
  for (std::size_t begin = 0; begin <= line.size();) {
    const std::size_t end = std::min(line.find(',', begin), line.size());
    fields.emplace_back(line.substr(begin, end - begin));
    begin = end + 1;
  }
  return fields;
}

}  // namespace

CsvTable::CsvTable(std::string_view text) {
  int number = 0;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    ++number;
    if (line.empty() || line.front() == '#') continue;
    auto fields = fields_of(line);
    if (columns_.empty()) {
      columns_ = std::move(fields);
    } else if (fields.size() == columns_.size()) {
      rows_.push_back(std::move(fields));
    } else {
      throw std::invalid_argument("line " + std::to_string(number) + ": " +
                                  std::to_string(fields.size()) + " fields where the heading has " +
                                  std::to_string(columns_.size()));
    }
  }
  if (columns_.empty()) throw std::invalid_argument("a table without a heading");
}

const std::string& CsvTable::text(std::size_t row, std::string_view column) const {
  const auto found = std::find(columns_.begin(), columns_.end(), column);
  if (found == columns_.end()) {
    throw std::invalid_argument("no column " + std::string(column));
  }
  return rows_.at(row)[static_cast<std::size_t>(found - columns_.begin())];
}

double CsvTable::number(std::size_t row, std::string_view column) const {
  const std::string& field = text(row, column);
  double value = 0;
  const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), value);
  if (error != std::errc() || end != field.data() + field.size()) {
    throw std::invalid_argument(std::string(column) + " = " + field + ": not a number");
  }
  return value;
}

namespace {

CsvTable table(std::string_view file) {
  return CsvTable(yardstick_text(file));
}

std::vector<BeamRow> beam_rows(std::string_view file, hw::ProbePreset preset) {
  const CsvTable csv = table(file);
  std::vector<BeamRow> rows;
  for (std::size_t i = 0; i < csv.rows(); ++i) {
    if (csv.text(i, "preset") != table_name(preset)) continue;
    const auto length_m = [&](std::string_view column) { return csv.number(i, column) * 1e-3; };
    rows.push_back({csv.number(i, "sector_fraction"),
                    length_m("depth_mm"),
                    csv.number(i, "theta_deg") * kDegree,
                    length_m("lateral_mm"),
                    length_m("elevation_mm"),
                    length_m("axial_mm"),
                    csv.number(i, "level_db")});
  }
  return rows;
}

/// Levels re the middle stick at the same range, instead of re one range.
std::vector<BeamRow> re_middle(std::vector<BeamRow> rows) {
  const std::vector<BeamRow> all = rows;
  for (BeamRow& row : rows) {
    const auto middle = std::ranges::find_if(all, [&](const BeamRow& other) {
      return other.sector_fraction == 0 && other.range_m == row.range_m;
    });
    if (middle == all.end()) throw std::invalid_argument("no middle stick at a range");
    row.level_db -= middle->level_db;
  }
  return rows;
}

}  // namespace

std::string_view table_name(hw::ProbePreset preset) {
  switch (preset) {
    case hw::ProbePreset::standard:
      return "standard";
    case hw::ProbePreset::c5_2v:
      return "c5_2v";
    case hw::ProbePreset::curvilinear_60:
      return "curvilinear_60";
  }
  throw std::logic_error("ProbePreset: no such preset");
}

std::vector<BeamRow> point_width_rows(hw::ProbePreset preset) {
  return re_middle(beam_rows("point_widths.csv", preset));
}

double axis_level_db(hw::ProbePreset preset, double range_m) {
  std::vector<BeamRow> axis = beam_rows("point_widths.csv", preset);
  std::erase_if(axis, [](const BeamRow& row) { return row.sector_fraction != 0; });
  std::size_t next = 1;
  while (next + 1 < axis.size() && axis[next].range_m < range_m) ++next;
  const BeamRow &from = axis.at(next - 1), &to = axis.at(next);
  return std::lerp(
      from.level_db, to.level_db, (range_m - from.range_m) / (to.range_m - from.range_m));
}

std::vector<BeamRow> speckle_rows(hw::ProbePreset preset) {
  return re_middle(beam_rows("speckle.csv", preset));
}

std::vector<BeamRow> stick_beam_rows(hw::ProbePreset preset) {
  const CsvTable csv = table("stick_beam.csv");
  const double none = std::numeric_limits<double>::quiet_NaN();
  std::vector<BeamRow> rows;
  for (std::size_t i = 0; i < csv.rows(); ++i) {
    if (csv.text(i, "preset") != table_name(preset)) continue;
    rows.push_back({csv.number(i, "sector_fraction"),
                    csv.number(i, "depth_mm") * 1e-3,
                    csv.number(i, "theta_deg") * kDegree,
                    csv.number(i, "lateral_mm") * 1e-3,
                    none,
                    none,
                    none});
  }
  return rows;
}

std::vector<BeamRow> attenuated_rows(double db_per_cm_mhz) {
  const CsvTable csv = table("attenuation.csv");
  std::vector<BeamRow> rows;
  for (std::size_t i = 0; i < csv.rows(); ++i) {
    if (csv.number(i, "alpha_db_cm_mhz") != db_per_cm_mhz) continue;
    rows.push_back({0,
                    csv.number(i, "depth_mm") * 1e-3,
                    0,
                    csv.number(i, "lateral_mm") * 1e-3,
                    csv.number(i, "elevation_mm") * 1e-3,
                    csv.number(i, "axial_mm") * 1e-3,
                    csv.number(i, "level_db")});
  }
  return rows;
}

std::vector<ShadowRow> shadow_rows() {
  const CsvTable csv = table("shadow.csv");
  std::vector<ShadowRow> rows;
  for (std::size_t i = 0; i < csv.rows(); ++i) {
    rows.push_back({csv.text(i, "edge") == "lateral",
                    csv.number(i, "depth_mm") * 1e-3,
                    csv.number(i, "crossing_mm") * 1e-3,
                    csv.number(i, "power_db"),
                    csv.number(i, "rise_mm") * 1e-3});
  }
  return rows;
}

std::vector<NeighbourRow> neighbour_rows() {
  const CsvTable csv = table("neighbours.csv");
  std::vector<NeighbourRow> rows;
  for (std::size_t i = 0; i < csv.rows(); ++i) {
    rows.push_back({csv.number(i, "depth_mm") * 1e-3,
                    csv.number(i, "line_correlation"),
                    csv.number(i, "frame_correlation")});
  }
  return rows;
}

namespace {

std::vector<EchoPlace> read_places(std::string_view points_file, std::string_view echoes_file) {
  std::vector<EchoPlace> places;
  const auto place_of = [&](const CsvTable& csv, std::size_t i) -> EchoPlace& {
    const auto number = static_cast<std::size_t>(csv.number(i, "place"));
    if (number >= places.size()) places.resize(number + 1);
    places[number].sector_fraction = csv.number(i, "sector_fraction");
    places[number].range_m = csv.number(i, "depth_mm") * 1e-3;
    return places[number];
  };
  const CsvTable points = table(points_file);
  for (std::size_t i = 0; i < points.rows(); ++i) {
    place_of(points, i).points.push_back({points.number(i, "axial_mm") * 1e-3,
                                          points.number(i, "lateral_mm") * 1e-3,
                                          points.number(i, "elevation_mm") * 1e-3,
                                          points.number(i, "amplitude")});
  }
  const CsvTable echoes = table(echoes_file);
  for (std::size_t i = 0; i < echoes.rows(); ++i) {
    EchoPlace& place = place_of(echoes, i);
    place.ranges_m.push_back(echoes.number(i, "range_mm") * 1e-3);
    place.envelope.push_back(echoes.number(i, "envelope"));
  }
  return places;
}

}  // namespace

std::vector<EchoPlace> echo_places() {
  return read_places("echo_points.csv", "echoes.csv");
}

std::vector<EchoPlace> main_lobe_places() {
  return read_places("main_lobe_points.csv", "main_lobe_echoes.csv");
}

}  // namespace wobblebench::bench
