#include "bench/output/error_report.h"

#include <algorithm>
#include <nlohmann/json.hpp>

namespace wobblebench::bench {

namespace {

using Json = nlohmann::ordered_json;

Json regions_json(const PictureMeasures& measures, const ExpectedSurface& expected) {
  Json regions = Json::array();
  for (const RegionError& region : measures.regions) {
    regions.push_back({{"group", region.group}, {"name", region.name}});
    regions.back().update(to_json(described(region, measures, expected)));
  }
  return regions;
}

}  // namespace

bool computes_surface(const ResolvedScene& scene) {
  return scene.render().ray_casting.mode != render::RenderMode::volume;
}

ExpectedSurface expected_surface(const ResolvedScene& scene) {
  const auto& subject = scene.subject();
  const auto is_target = [](const auto& surface) { return surface.is_target; };
  return {computes_surface(scene),
          subject && std::ranges::any_of(subject->phantom.surfaces(), is_target)};
}

std::string why_none(const DepthError& raw, const ExpectedSurface& expected) {
  return expected.in_phantom ? why_no_surface(raw) : "the phantom has no surface to detect";
}

Json error_json(const PictureMeasures& measures, const ExpectedSurface& expected) {
  Json json = to_json(described(measures, expected));
  const std::string nothing = why_none(measures.raw, expected);
  json["no_surface_because"] = nothing.empty() ? Json(nullptr) : Json(nothing);
  json["regions"] = regions_json(measures, expected);
  return json;
}

}  // namespace wobblebench::bench
