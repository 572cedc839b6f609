#include "bench/evaluation/measures/measure_table.h"

#include <functional>
#include <limits>
#include <utility>

namespace wobblebench::bench {

namespace {

constexpr double kUnset = std::numeric_limits<double>::quiet_NaN();

/// What a row is filled from: the whole picture, or one of its regions.
struct Source {
  const PictureMeasures& picture;
  const RegionError* region;  ///< null: the whole picture

  const DepthStatistics& depth() const { return region ? region->depth : picture.raw.depth; }
  const NormalStatistics& normal() const {
    return region ? region->normal : picture.filtered.normal;
  }
  const NormalStatistics& raw_normal() const {
    return region ? region->raw_normal : picture.raw.normal;
  }
  int surface() const { return region ? region->surface : picture.raw.surface; }
  int missed() const { return region ? region->missed : picture.raw.missed; }
  double share(int count) const { return 100.0 * count / picture.raw.pixels; }

  double missed_percent() const { return surface() > 0 ? share(missed()) : kUnset; }
  double missed_surface_percent() const {
    return region ? region->missed_surface_percent() : picture.raw.missed_surface_percent();
  }
  double false_percent() const {
    if (!picture.raw.surface_in_view()) return kUnset;
    if (!region) return picture.raw.false_percent();
    return region->group == "silhouette" ? share(region->false_surface) : kUnset;
  }
  double distance(double SurfaceDistance::*member) const {
    return region || !picture.distance ? kUnset : *picture.distance.*member / kMillimetre;
  }
};

using Column = std::pair<std::string, std::function<double(const Source&)>>;

const std::vector<Column>& columns() {
  static const std::vector<Column> all = {
      {"bias_mm", [](const Source& s) { return s.depth().bias_m / kMillimetre; }},
      {"median_mm", [](const Source& s) { return s.depth().median_m / kMillimetre; }},
      {"rms_mm", [](const Source& s) { return s.depth().rms_m / kMillimetre; }},
      {"p95_mm", [](const Source& s) { return s.depth().p95_m / kMillimetre; }},
      {"max_mm", [](const Source& s) { return s.depth().max_m / kMillimetre; }},
      {"pixels", [](const Source& s) { return 1.0 * s.depth().n; }},
      {"surface_percent", [](const Source& s) { return s.share(s.surface()); }},
      {"missed_percent", [](const Source& s) { return s.missed_percent(); }},
      {"missed_surface_percent", [](const Source& s) { return s.missed_surface_percent(); }},
      {"false_percent", [](const Source& s) { return s.false_percent(); }},
      {"false_surface_percent",
       [](const Source& s) { return s.region ? kUnset : s.picture.raw.false_surface_percent(); }},
      {"normal_mean_deg", [](const Source& s) { return s.normal().mean_rad / kDegree; }},
      {"normal_median_deg", [](const Source& s) { return s.normal().median_rad / kDegree; }},
      {"normal_p95_deg", [](const Source& s) { return s.normal().p95_rad / kDegree; }},
      {"raw_normal_mean_deg", [](const Source& s) { return s.raw_normal().mean_rad / kDegree; }},
      {"raw_normal_median_deg",
       [](const Source& s) { return s.raw_normal().median_rad / kDegree; }},
      {"raw_normal_p95_deg", [](const Source& s) { return s.raw_normal().p95_rad / kDegree; }},
      {"distance_mean_mm", [](const Source& s) { return s.distance(&SurfaceDistance::mean_m); }},
      {"distance_p95_mm", [](const Source& s) { return s.distance(&SurfaceDistance::p95_m); }},
      {"hausdorff95_mm",
       [](const Source& s) { return s.distance(&SurfaceDistance::hausdorff95_m); }},
      {"ssim", [](const Source& s) { return s.region ? kUnset : s.picture.shaded.ssim; }}};
  return all;
}

MeasureRow row_of(const std::string& group, const std::string& region, const Source& source) {
  MeasureRow row{group, region, {}};
  for (const auto& [name, value] : columns()) row.values.push_back(value(source));
  return row;
}

}  // namespace

const std::vector<std::string>& measure_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all;
    for (const auto& [name, value] : columns()) all.push_back(name);
    return all;
  }();
  return names;
}

std::vector<MeasureRow> measure_rows(const PictureMeasures& measures) {
  std::vector<MeasureRow> rows = {row_of("picture", "all", {measures, nullptr})};
  for (const RegionError& region : measures.regions) {
    rows.push_back(row_of(region.group, region.name, {measures, &region}));
  }
  return rows;
}

}  // namespace wobblebench::bench
