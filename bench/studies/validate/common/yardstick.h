// The tables of tests/yardstick: what a sum over the probe's elements, written apart from the
// simulator, makes of the presets' beams. They are embedded in the program at build time.
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "hw/probe/probe.h"

namespace wobblebench::bench {

/// A comma-separated table with a heading: fields without quotes; lines that begin with # are
/// comments.
class CsvTable {
 public:
  /// Throws std::invalid_argument, which names the line, if a line has not as many fields as the
  /// heading, or there is none.
  explicit CsvTable(std::string_view text);

  std::size_t rows() const { return rows_.size(); }
  bool has(std::string_view column) const;
  /// Throws std::invalid_argument for a column that is not in the heading.
  const std::string& text(std::size_t row, std::string_view column) const;
  /// Throws std::invalid_argument also for a field that is not a number.
  double number(std::size_t row, std::string_view column) const;

 private:
  std::vector<std::string> columns_;
  std::vector<std::vector<std::string>> rows_;
};

/// Text of a table, by its file name; empty if there is none of that name.
std::string_view yardstick_text(std::string_view file);

inline constexpr hw::ProbePreset kPresets[] = {
    hw::ProbePreset::standard, hw::ProbePreset::c5_2v, hw::ProbePreset::curvilinear_60};

/// As in the tables: "standard", "c5_2v", "curvilinear_60".
std::string_view table_name(hw::ProbePreset preset);

/// A row of point_widths.csv or speckle.csv: the beam at one point of the sector.
struct BeamRow {
  double sector_fraction = 0;  ///< stick's angle over half the sector
  double range_m = 0;
  double theta_rad = 0;
  double lateral_m = 0;
  double elevation_m = 0;
  double axial_m = 0;
  double level_db = 0;  ///< re the middle stick at the same range
};
/// What was measured at a row's point; NaN: the rung has no such figure.
struct BeamComparison {
  BeamRow expected;  ///< the table's
  BeamRow measured;
};

/// -6 dB widths of the echo of one point, by angle and range.
std::vector<BeamRow> point_width_rows(hw::ProbePreset preset);
/// Widths of each stick's own beam across lines; the others are NaN: stick_beam.csv.
std::vector<BeamRow> stick_beam_rows(hw::ProbePreset preset);
/// Echo of a point on the middle stick's axis over that at the transmit focus: linear between the
/// table's ranges, and beyond them from the last two.
double axis_level_db(hw::ProbePreset preset, double range_m);
/// Widths at half maximum of the autocovariance of the intensity of speckle.
std::vector<BeamRow> speckle_rows(hw::ProbePreset preset);

/// A row of neighbours.csv: the middle stick of the default scan.
struct NeighbourRow {
  double range_m = 0;
  double line_correlation = 0;
  double frame_correlation = 0;
};
std::vector<NeighbourRow> neighbour_rows();

/// Echo of a point on the middle stick in tissue of this one-way attenuation, over that in tissue
/// without any: attenuation.csv.
std::vector<BeamRow> attenuated_rows(double db_per_cm_mhz);

/// What losses that grow with frequency leave of the mean echo of uniform tissue on the middle
/// stick, each frequency attenuated by itself: tissue_band.csv.
class TissueBand {
 public:
  explicit TissueBand(hw::ProbePreset preset);

  /// Power left after a two-way loss of `loss_db` at `center_hz`, between the table's ranges linear
  /// in dB.
  double level_db(double loss_db, double center_hz, double range_m) const;

 private:
  struct Share {
    double hz;
    double power;
  };
  std::map<double, std::vector<Share>> shares_;  ///< by range
};

/// Uniform tissue behind a half plane across the middle stick: shadow.csv.
struct ShadowRow {
  bool across_lines = false;  ///< the plane's edge lies across the image plane's lines
  double range_m = 0;
  double crossing_m = 0;  ///< of the stick's axis and the plane, from its edge
  double level_db = 0;    ///< mean power over that without the plane
  double rise_m = 0;      ///< 10 to 90 % of the amplitude: the same in all rows of a range
};
std::vector<ShadowRow> shadow_rows();

/// Points about one place of a stick, and the envelope of their echo.
struct EchoPlace {
  double sector_fraction = 0;
  double range_m = 0;
  struct Point {
    double axial_m = 0;      ///< range along the stick
    double lateral_m = 0;    ///< towards larger stick angles
    double elevation_m = 0;  ///< towards +y of the probe frame
    double amplitude = 0;
  };
  std::vector<Point> points;
  std::vector<double> ranges_m;
  /// Re the peak for one point of amplitude 1 on the middle stick at the place's range.
  std::vector<double> envelope;
};
/// Points off the axis, out to the side lobes: echo_points.csv, echoes.csv.
std::vector<EchoPlace> echo_places();
/// Points well within the focused beam's main lobe: main_lobe_points.csv, main_lobe_echoes.csv.
std::vector<EchoPlace> main_lobe_places();

}  // namespace wobblebench::bench
