#include "bench/studies/trade/trade_record.h"

#include <algorithm>
#include <functional>
#include <limits>
#include <stdexcept>
#include <utility>

#include "base/units.h"

namespace wobblebench::bench {

namespace {

constexpr double kUnset = std::numeric_limits<double>::quiet_NaN();

const DepthStatistics* outside_silhouettes(const PictureMeasures& measures) {
  for (const RegionError& region : measures.regions) {
    if (region.group == "silhouette" && region.name == "outside") return &region.depth;
  }
  return nullptr;
}

double outside(const PictureMeasures& measures, double DepthStatistics::*member) {
  const DepthStatistics* statistics = outside_silhouettes(measures);
  return statistics == nullptr ? kUnset : statistics->*member / kMillimetre;
}

using Column = std::pair<std::string, std::function<double(const PictureMeasures&)>>;

const std::vector<Column>& columns() {
  using M = const PictureMeasures&;
  static const std::vector<Column> all = {
      {"median_mm", [](M m) { return m.raw.depth.median_m / kMillimetre; }},
      {"rms_mm", [](M m) { return m.raw.depth.rms_m / kMillimetre; }},
      {"p95_mm", [](M m) { return m.raw.depth.p95_m / kMillimetre; }},
      {"outside_rms_mm", [](M m) { return outside(m, &DepthStatistics::rms_m); }},
      {"outside_p95_mm", [](M m) { return outside(m, &DepthStatistics::p95_m); }},
      {"missed_percent", [](M m) { return m.raw.missed_percent(); }},
      {"false_percent", [](M m) { return m.raw.false_percent(); }},
      {"missed_or_false_percent",
       [](M m) { return m.raw.missed_percent() + m.raw.false_percent(); }},
      {"normal_median_deg", [](M m) { return m.filtered.normal.median_rad / kDegree; }}};
  return all;
}

}  // namespace

const std::vector<std::string>& trade_measure_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> result;
    for (const auto& [name, value] : columns()) result.push_back(name);
    return result;
  }();
  return names;
}

std::vector<double> trade_measures(const PictureMeasures& measures) {
  std::vector<double> values;
  for (const auto& [name, value] : columns()) {
    values.push_back(measures.raw.surface_in_view() ? value(measures) : kUnset);
  }
  return values;
}

std::size_t trade_measure(const std::string& name) {
  const auto& names = trade_measure_names();
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end()) throw std::out_of_range("no measure " + name);
  return static_cast<std::size_t>(found - names.begin());
}

}  // namespace wobblebench::bench
