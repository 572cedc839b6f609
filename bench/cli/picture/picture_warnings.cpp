#include "bench/cli/picture/picture_warnings.h"

#include <algorithm>
#include <cmath>

#include "base/number_text.h"
#include "base/units.h"
#include "render/geometry/ray_sampling.h"
#include "render/reconstruction/echo_levels.h"

namespace wobblebench::bench {

namespace {

constexpr double kNearField_m = 5e-3;     ///< range in which a probe's own ringing is seen
constexpr double kNearFieldShare = 0.05;  ///< of the found pixels
constexpr double kInFront_m = 5e-3;       ///< median error of a picture of another surface
constexpr double kFalseShare = 0.05;      ///< of the picture
constexpr int kStride = 4;                ///< of the pixels that are looked at

bool is_surface(float depth_m) {
  return !std::isnan(depth_m);  // kNoSurface
}

bool any_surface(const render::Picture& picture) {
  return std::ranges::any_of(picture.depth_m.pixels, is_surface);
}

bool box_misses_sector(const ResolvedScene& scene) {
  const auto spans = render::spans_in_box(scene.plan(), scene.render().volume_of_interest);
  return std::ranges::all_of(spans, [](const auto& span) { return span.begin >= span.end; });
}

std::string level_text(double level) {
  return significant(level, 3);
}

/// Why no ray met a surface.
std::string why_none(const render::Picture& picture, const ResolvedScene& scene) {
  if (box_misses_sector(scene)) {
    const hw::AcquisitionOptions& scan = scene.plan().acquisition();
    return "no stick passes render.volume_of_interest: it lies outside the scanned sector, fan and "
           "depth, or between the " +
           std::to_string(scan.sticks_per_frame) + " sticks of " +
           std::to_string(scan.frames_per_volume) + " frames";
  }
  const render::RayCastingOptions& o = scene.render().ray_casting;
  if (o.detector == render::Detector::paper) {
    const double threshold = render::difference_threshold(scene.render());
    return "on no ray Difference reached the threshold, " + level_text(threshold) + " over " +
           std::to_string(render::buffer_samples(scene.render())) +
           " samples (render.ray_casting.threshold)";
  }
  if (!picture.levels) return "no ray met a surface";
  const std::string levels = "fluid " + level_text(picture.levels->fluid) + ", tissue " +
                             level_text(picture.levels->tissue);
  if (!picture.levels->separate) {
    return "echoes in render.volume_of_interest are of one kind; fluid and tissue cannot be told "
           "apart (" +
           levels + ")";
  }
  if (!o.iso_level) return "no ray crossed the level of its sticks (" + levels + ")";
  return "no ray crossed render.ray_casting.iso_level = " + level_text(*o.iso_level) +
         " of the way from fluid to tissue (" + levels + ")";
}

/// Share of the found pixels that lie at the face of the probe.
double near_field_share(const render::Picture& picture, const ResolvedScene& scene) {
  const hw::ProbeGeometry geometry = scene.plan().geometry();
  int found = 0, near = 0;
  for (int row = 0; row < picture.depth_m.height; row += kStride) {
    for (int column = 0; column < picture.depth_m.width; column += kStride) {
      const float depth_m = picture.depth_m.at(column, row);
      if (!is_surface(depth_m)) continue;
      ++found;
      const auto point = scene.view().camera.ray(column, row).at(double{depth_m});
      near += geometry.to_polar(point).range_m < kNearField_m ? 1 : 0;
    }
  }
  return found == 0 ? 0 : static_cast<double>(near) / found;
}

std::string against_truth(const DepthError& error) {
  const double false_share = static_cast<double>(error.false_surface) / error.pixels;
  if (!error.surface_in_view()) {
    if (false_share < kFalseShare) return "";
    return "the phantom has no surface in view: the picture, " + significant(100 * false_share, 3) +
           " % of it, shows what the detector makes of point scatterers, speckle and noise";
  }
  if (!(error.depth.median_m < -kInFront_m)) return "";
  return "the picture shows another surface in front of the true one, nearer by a median of " +
         significant(-error.depth.median_m / kMillimetre, 3) +
         " mm: the near field or the maternal wall lies within render.volume_of_interest";
}

}  // namespace

std::vector<std::string> picture_warnings(const render::Picture& picture,
                                          const ResolvedScene& scene,
                                          const DepthError* error) {
  if (scene.render().ray_casting.mode == render::RenderMode::volume) return {};
  if (!any_surface(picture)) {
    return {"the picture shows no surface and is black: " + why_none(picture, scene)};
  }
  std::vector<std::string> warnings;
  const double near = near_field_share(picture, scene);
  if (near >= kNearFieldShare) {
    warnings.push_back(fixed(100 * near, 0) +
                       " % of the surface in the picture lies within 5 mm of the probe: the near "
                       "field is within render.volume_of_interest and hides what lies behind it");
  }
  if (error != nullptr) {
    const std::string other = against_truth(*error);
    if (!other.empty()) warnings.push_back(other);
  }
  return warnings;
}

}  // namespace wobblebench::bench
