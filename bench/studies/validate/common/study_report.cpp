#include "bench/studies/validate/common/study_report.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "base/number_text.h"

namespace wobblebench::bench {

namespace {

using ErrorOf = std::function<double(const BeamComparison&)>;

std::string whole_mm(double metres) {
  return std::to_string(std::lround(metres * 1e3));
}

std::string place_text(const BeamRow& place) {
  std::string range = whole_mm(place.range_m) + " mm";
  if (place.sector_fraction == 0) return range;
  return range + ", " + significant(place.sector_fraction, 3) + " of the half sector";
}

/// The comparison of the largest error; NaN is larger than any. Null where there is none.
const BeamComparison* worst_of(std::span<const BeamComparison> found, const ErrorOf& error) {
  const auto rank = [&](const BeamComparison& one) {
    const double e = std::abs(error(one));
    return std::isnan(e) ? HUGE_VAL : e;
  };
  const auto at = std::ranges::max_element(found, {}, rank);
  return at == found.end() ? nullptr : &*at;
}

Check worst(const std::string& name,
            std::span<const BeamComparison> found,
            const ErrorOf& error,
            double bar,
            const std::string& unit,
            const std::function<std::string(const BeamRow&)>& text,
            const CheckedOver& over) {
  const BeamComparison* at = worst_of(found, error);
  const std::string source = at == nullptr
                                 ? "no place"
                                 : "worst at " + place_text(at->expected) + ": " +
                                       text(at->measured) + ", table " + text(at->expected);
  return Check{name}
      .at_most(at == nullptr ? std::nan("") : std::abs(error(*at)), bar, unit)
      .from(source)
      .over(static_cast<long>(found.size()), over.of, over.seeds);
}

std::string fraction_text(double fraction) {
  return fraction == 0 ? "axis" : significant(fraction, 3);
}

std::vector<double> fractions_of(std::span<const BeamComparison> found) {
  std::vector<double> fractions;
  for (const auto& one : found) fractions.push_back(one.expected.sector_fraction);
  std::ranges::sort(fractions);
  // clang 14 cannot read std::ranges::unique of libstdc++ 12.
  fractions.erase(std::unique(fractions.begin(), fractions.end()), fractions.end());
  return fractions;
}

Series width_series(const std::string& name,
                    std::span<const BeamComparison> found,
                    double fraction,
                    BeamRow BeamComparison::*row,
                    double BeamRow::*value) {
  Series series;
  series.name = name;
  for (const auto& one : found) {
    if (one.expected.sector_fraction != fraction) continue;
    series.add(one.expected.range_m * 1e3, (one.*row).*value * 1e3);
  }
  return series;
}

Chart width_chart(const std::string& title,
                  const BeamWidth& width,
                  std::span<const ChartedRung> rungs) {
  Chart chart{title, {"range (mm)"}, {std::string(width.name) + " width (mm)"}};
  chart.y.low = 0.0;
  const auto& table = rungs.front().found;
  const auto fractions = fractions_of(table);
  for (std::size_t i = 0; i < fractions.size(); ++i) {
    const std::string name = "table, " + fraction_text(fractions[i]);
    chart.series.push_back(
        width_series(name, table, fractions[i], &BeamComparison::expected, width.value));
    chart.series.back().colour = static_cast<int>(i);
  }
  for (const ChartedRung& rung : rungs) {
    for (std::size_t i = 0; i < fractions.size(); ++i) {
      Series series = width_series(i == 0 ? rung.name : "",
                                   rung.found,
                                   fractions[i],
                                   &BeamComparison::measured,
                                   width.value);
      series.stroke = Stroke::none;
      series.mark = rung.mark;
      series.colour = static_cast<int>(i);
      chart.series.push_back(std::move(series));
    }
  }
  return chart;
}

}  // namespace

bool Check::passed() const {
  switch (kind) {
    case Kind::within:
      return std::abs(measured - expected) <= tolerance;
    case Kind::at_least:
      return measured >= expected;
    case Kind::at_most:
      return measured <= expected;
  }
  return false;
}

Check& Check::within(double value, double wanted, double allowed, const std::string& their_unit) {
  kind = Kind::within;
  measured = value;
  expected = wanted;
  tolerance = allowed;
  unit = their_unit;
  return *this;
}

Check& Check::at_least(double value, double bar, const std::string& their_unit) {
  within(value, bar, 0, their_unit).kind = Kind::at_least;
  return *this;
}

Check& Check::at_most(double value, double bar, const std::string& their_unit) {
  within(value, bar, 0, their_unit).kind = Kind::at_most;
  return *this;
}

Check& Check::from(const std::string& text) {
  source = text;
  return *this;
}

Check& Check::over(long count, const std::string& kind_of, std::vector<std::uint64_t> with_seeds) {
  n = count;
  of = kind_of;
  seeds = std::move(with_seeds);
  return *this;
}

Check& StudyReport::check(const std::string& name) {
  checks.push_back({.name = name});
  return checks.back();
}

void StudyReport::point(const std::string& series, const X& x, const Y& y) {
  points.push_back({series, x.name, x.value, y.name, y.value, y.expected});
}

std::vector<BeamComparison> at_places(std::span<const BeamComparison> found,
                                      StickPlaces places,
                                      double from_m,
                                      double to_m) {
  std::vector<BeamComparison> chosen;
  std::ranges::copy_if(found, std::back_inserter(chosen), [&](const BeamComparison& one) {
    const bool middle = one.expected.sector_fraction == 0;
    return middle == (places == StickPlaces::axis) && one.expected.range_m >= from_m &&
           one.expected.range_m <= to_m;
  });
  return chosen;
}

Check worst_width(const std::string& name,
                  std::span<const BeamComparison> found,
                  const BeamWidth& width,
                  double bar_percent,
                  const CheckedOver& over) {
  return worst(
      name,
      found,
      [&](const BeamComparison& one) {
        return 100 * (one.measured.*width.value / one.expected.*width.value - 1);
      },
      bar_percent,
      "%",
      [&](const BeamRow& row) { return significant(row.*width.value * 1e3, 3) + " mm"; },
      over);
}

Check worst_level(const std::string& name,
                  std::span<const BeamComparison> found,
                  double bar_db,
                  const CheckedOver& over) {
  return worst(
      name,
      found,
      [](const BeamComparison& one) { return one.measured.level_db - one.expected.level_db; },
      bar_db,
      "dB",
      [](const BeamRow& row) { return fixed(row.level_db, 2) + " dB"; },
      over);
}

void add_points(const std::string& series,
                std::span<const BeamComparison> found,
                StudyReport& report) {
  for (const auto& one : found) {
    const std::string name = series + " " + fraction_text(one.expected.sector_fraction);
    const double mm = one.expected.range_m * 1e3;
    const auto add = [&](const std::string& what, double measured, double expected) {
      if (!std::isnan(measured)) report.point(name, {"range_mm", mm}, {what, measured, expected});
    };
    for (const BeamWidth& width : {kLateral, kElevation, kAxial}) {
      add(std::string(width.name) + "_mm",
          one.measured.*width.value * 1e3,
          one.expected.*width.value * 1e3);
    }
    add("level_db", one.measured.level_db, one.expected.level_db);
  }
}

Figure widths_figure(const std::string& study,
                     const std::string& what,
                     hw::ProbePreset preset,
                     std::span<const ChartedRung> rungs) {
  const std::string name(table_name(preset));
  return {study + "_" + name,
          "Widths of " + what + ", preset " + name +
              ": on the axis and towards the edge of the sector. Lines: tables of tests/yardstick.",
          {width_chart("Across lines", kLateral, rungs),
           width_chart("Across frames", kElevation, rungs)}};
}

}  // namespace wobblebench::bench
