#include "bench/output/error_report.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "base/units.h"
#include "bench/output/report_parts.h"

namespace wobblebench::bench {

namespace {

using Json = nlohmann::ordered_json;

Json mm(double metres) {
  return number(metres / kMillimetre);
}

Json depth_json(const DepthStatistics& depth) {
  return {{"bias", mm(depth.bias_m)},
          {"rms", mm(depth.rms_m)},
          {"median", mm(depth.median_m)},
          {"p95", mm(depth.p95_m)},
          {"max", mm(depth.max_m)},
          {"outliers_percent", number(100 * depth.outlier_share)},
          {"n", depth.n}};
}

Json normal_json(const NormalStatistics& normal) {
  return {{"mean", number(normal.mean_rad / kDegree)},
          {"median", number(normal.median_rad / kDegree)},
          {"p95", number(normal.p95_rad / kDegree)},
          {"n", normal.n}};
}

Json directed_json(const DirectedDistance& distance) {
  return {{"mean", mm(distance.mean_m)},
          {"p95", mm(distance.p95_m)},
          {"max", mm(distance.max_m)},
          {"n", distance.n}};
}

Json distance_json(const SurfaceDistance& distance) {
  return {{"mean", mm(distance.mean_m)},
          {"p95", mm(distance.p95_m)},
          {"hausdorff95", mm(distance.hausdorff95_m)},
          {"found_to_true", directed_json(distance.found_to_true)},
          {"true_to_found", directed_json(distance.true_to_found)}};
}

Json region_json(const RegionError& region, int pixels, bool surface_sought) {
  const bool has_false = region.group == "silhouette";
  const auto percent = [&](bool formed, double value) {
    return surface_sought && formed ? number(value) : Json(nullptr);
  };
  return {{"group", region.group},
          {"name", region.name},
          {"depth_mm", depth_json(region.depth)},
          {"surface_percent", 100.0 * region.surface / pixels},
          {"surface_cm2", region.surface_m2 * 1e4},
          {"missed_percent", percent(region.surface > 0, 100.0 * region.missed / pixels)},
          {"missed_surface_percent", percent(region.surface > 0, region.missed_surface_percent())},
          {"false_percent", percent(has_false, 100.0 * region.false_surface / pixels)},
          {"raw_normal_deg", normal_json(region.raw_normal)},
          {"normal_deg", normal_json(region.normal)}};
}

Json regions_json(const PictureMeasures& measures, bool surface_sought) {
  Json regions = Json::array();
  for (const RegionError& region : measures.regions) {
    regions.push_back(region_json(region, measures.raw.pixels, surface_sought));
  }
  return regions;
}

}  // namespace

bool computes_surface(const ResolvedScene& scene) {
  return scene.render().ray_casting.mode != render::RenderMode::volume;
}

Sought sought_in(const ResolvedScene& scene) {
  const auto& subject = scene.subject();
  const auto is_target = [](const auto& surface) { return surface.is_target; };
  return {computes_surface(scene),
          subject && std::ranges::any_of(subject->phantom.surfaces(), is_target)};
}

std::string why_none(const DepthError& raw, const Sought& sought) {
  return sought.target ? why_no_surface(raw) : "the phantom has no surface to detect";
}

Json error_json(const PictureMeasures& measures, const Sought& sought) {
  const DepthError& raw = measures.raw;
  const bool in_view = raw.surface_in_view();
  const bool any_false = sought.target && raw.false_surface > 0;
  const auto percent = [&](bool formed, double value) {
    return sought.surface && formed ? number(value) : Json(nullptr);
  };
  const auto share = [&](int count) { return 100.0 * count / raw.pixels; };
  const std::string nothing = why_none(raw, sought);
  const RegionError* grazing = measures.grazing();
  return {{"depth_mm", depth_json(raw.depth)},
          {"missed_percent", percent(in_view, raw.missed_percent())},
          {"missed_surface_percent", percent(in_view, raw.missed_surface_percent())},
          {"false_percent", percent(in_view || any_false, raw.false_percent())},
          {"false_surface_percent", percent(in_view || any_false, raw.false_surface_percent())},
          {"surface_percent", share(raw.surface)},
          {"surface_cm2", raw.surface_m2 * 1e4},
          {"found_surface_cm2", raw.found_m2 * 1e4},
          {"no_surface_because", nothing.empty() ? Json(nullptr) : Json(nothing)},
          {"outside_field_percent", share(raw.outside_field)},
          {"grazing_percent", share(raw.grazing)},
          {"grazing_missed_percent",
           percent(grazing != nullptr, grazing ? grazing->missed_pixels_percent() : 0)},
          {"grazing_p95_mm", grazing ? mm(grazing->depth.p95_m) : Json(nullptr)},
          {"shadowed_percent", share(raw.shadowed)},
          {"pixels", raw.pixels},
          {"filtered_depth_mm", depth_json(measures.filtered.depth)},
          {"normal_deg", normal_json(measures.filtered.normal)},
          {"raw_normal_deg", normal_json(raw.normal)},
          {"surface_distance_mm",
           measures.distance ? distance_json(*measures.distance) : Json(nullptr)},
          {"shaded_against_truth",
           {{"ssim", number(measures.shaded.ssim)}, {"psnr_db", number(measures.shaded.psnr_db)}}},
          {"regions", regions_json(measures, sought.surface)}};
}

}  // namespace wobblebench::bench
