#include "bench/studies/validate/yardstick.h"

#include <algorithm>
#include <stdexcept>

#include "base/units.h"

namespace wobblebench::bench {

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
  std::vector<BeamRow> relative = rows;
  for (BeamRow& row : relative) {
    const auto middle = std::ranges::find_if(rows, [&](const BeamRow& other) {
      return other.sector_fraction == 0 && other.range_m == row.range_m;
    });
    if (middle == rows.end()) throw std::invalid_argument("no middle stick at a range");
    row.level_db -= middle->level_db;
  }
  return relative;
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
  return beam_rows("point_widths.csv", preset);
}

std::vector<BeamRow> speckle_rows(hw::ProbePreset preset) {
  return beam_rows("speckle.csv", preset);
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

std::vector<EchoPlace> echo_places() {
  std::vector<EchoPlace> places;
  const auto place_of = [&](const CsvTable& csv, std::size_t i) -> EchoPlace& {
    const auto number = static_cast<std::size_t>(csv.number(i, "place"));
    if (number >= places.size()) places.resize(number + 1);
    places[number].sector_fraction = csv.number(i, "sector_fraction");
    places[number].range_m = csv.number(i, "depth_mm") * 1e-3;
    return places[number];
  };
  const CsvTable points = table("echo_points.csv");
  for (std::size_t i = 0; i < points.rows(); ++i) {
    place_of(points, i).points.push_back({points.number(i, "axial_mm") * 1e-3,
                                          points.number(i, "lateral_mm") * 1e-3,
                                          points.number(i, "elevation_mm") * 1e-3,
                                          points.number(i, "amplitude")});
  }
  const CsvTable echoes = table("echoes.csv");
  for (std::size_t i = 0; i < echoes.rows(); ++i) {
    EchoPlace& place = place_of(echoes, i);
    place.ranges_m.push_back(echoes.number(i, "range_mm") * 1e-3);
    place.envelope.push_back(echoes.number(i, "envelope"));
  }
  return places;
}

}  // namespace wobblebench::bench
