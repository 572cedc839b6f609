#include "bench/studies/validate/common/yardstick.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <iterator>
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

bool CsvTable::has(std::string_view column) const {
  return std::find(columns_.begin(), columns_.end(), column) != columns_.end();
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

/// One line of a table.
struct TableLine {
  const CsvTable& table;
  std::size_t row;

  const std::string& text(std::string_view column) const { return table.text(row, column); }
  double number(std::string_view column) const { return table.number(row, column); }
  double metres(std::string_view mm_column) const { return number(mm_column) * 1e-3; }
  /// `otherwise` where the table has no such column.
  double number(std::string_view column, double otherwise) const {
    return table.has(column) ? number(column) : otherwise;
  }
};

/// Calls `visit` for each line of an embedded table.
template <class Visit>
void for_lines(std::string_view file, const Visit& visit) {
  const CsvTable table(yardstick_text(file));
  for (std::size_t i = 0; i < table.rows(); ++i) visit(TableLine{table, i});
}

/// Rows of the lines that are wanted. A table without stick angles is of the middle stick; widths
/// and levels that it does not have are NaN.
template <class Wanted>
std::vector<BeamRow> beam_rows(std::string_view file, const Wanted& wanted) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  std::vector<BeamRow> rows;
  for_lines(file, [&](const TableLine& line) {
    if (!wanted(line)) return;
    rows.push_back({line.number("sector_fraction", 0),
                    line.metres("depth_mm"),
                    line.number("theta_deg", 0) * kDegree,
                    line.metres("lateral_mm"),
                    line.number("elevation_mm", kNone) * 1e-3,
                    line.number("axial_mm", kNone) * 1e-3,
                    line.number("level_db", kNone)});
  });
  return rows;
}

std::vector<BeamRow> beam_rows(std::string_view file, hw::ProbePreset preset) {
  return beam_rows(
      file, [&](const TableLine& line) { return line.text("preset") == table_name(preset); });
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

std::vector<EchoPlace> read_places(std::string_view points_file, std::string_view echoes_file) {
  std::vector<EchoPlace> places;
  const auto place_of = [&](const TableLine& line) -> EchoPlace& {
    const auto number = static_cast<std::size_t>(line.number("place"));
    if (number >= places.size()) places.resize(number + 1);
    places[number].sector_fraction = line.number("sector_fraction");
    places[number].range_m = line.metres("depth_mm");
    return places[number];
  };
  for_lines(points_file, [&](const TableLine& line) {
    place_of(line).points.push_back({line.metres("axial_mm"),
                                     line.metres("lateral_mm"),
                                     line.metres("elevation_mm"),
                                     line.number("amplitude")});
  });
  for_lines(echoes_file, [&](const TableLine& line) {
    EchoPlace& place = place_of(line);
    place.ranges_m.push_back(line.metres("range_mm"));
    place.envelope.push_back(line.number("envelope"));
  });
  return places;
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
  return beam_rows("stick_beam.csv", preset);
}

TissueBand::TissueBand(hw::ProbePreset preset) {
  for_lines("tissue_band.csv", [&](const TableLine& line) {
    if (line.text("preset") != table_name(preset) || line.number("sector_fraction") != 0) return;
    shares_[line.metres("depth_mm")].push_back({line.number("mhz") * 1e6, line.number("share")});
  });
}

double TissueBand::level_db(double loss_db, double center_hz, double range_m) const {
  const auto left_db = [&](const std::vector<Share>& shares) {
    double left = 0;
    for (const Share& share : shares) {
      left += share.power * std::pow(10.0, -loss_db * share.hz / center_hz / 10);
    }
    return 10 * std::log10(left);
  };
  auto behind = shares_.lower_bound(range_m);
  if (behind == shares_.begin()) ++behind;
  if (behind == shares_.end()) --behind;
  const auto before = std::prev(behind);
  return std::lerp(left_db(before->second),
                   left_db(behind->second),
                   (range_m - before->first) / (behind->first - before->first));
}

std::vector<BeamRow> attenuated_rows(double db_per_cm_mhz) {
  return beam_rows("attenuation.csv", [&](const TableLine& line) {
    return line.number("alpha_db_cm_mhz") == db_per_cm_mhz;
  });
}

std::vector<ShadowRow> shadow_rows() {
  std::vector<ShadowRow> rows;
  for_lines("shadow.csv", [&](const TableLine& line) {
    rows.push_back({line.text("edge") == "lateral",
                    line.metres("depth_mm"),
                    line.metres("crossing_mm"),
                    line.number("power_db"),
                    line.metres("rise_mm")});
  });
  return rows;
}

std::vector<NeighbourRow> neighbour_rows() {
  std::vector<NeighbourRow> rows;
  for_lines("neighbours.csv", [&](const TableLine& line) {
    rows.push_back({line.metres("depth_mm"),
                    line.number("line_correlation"),
                    line.number("frame_correlation")});
  });
  return rows;
}

std::vector<EchoPlace> echo_places() {
  return read_places("echo_points.csv", "echoes.csv");
}

std::vector<EchoPlace> main_lobe_places() {
  return read_places("main_lobe_points.csv", "main_lobe_echoes.csv");
}

}  // namespace wobblebench::bench
