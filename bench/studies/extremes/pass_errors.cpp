#include "bench/studies/extremes/pass_errors.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <glm/common.hpp>
#include <limits>

#include "bench/studies/extremes/pass_bounds.h"
#include "render/passes/outline.h"
#include "render/passes/surface_depth.h"

namespace wobblebench::bench {

namespace {

using render::RenderOptions;
using render::reference::SliceStack;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// A z that continues its neighbours' is as wrong as they are, times at most this: the sum of the
/// magnitudes of a quadratic fit's weights outside the pixels that it was made of.
constexpr double kContinued = 100;

/// No surface lies behind all surfaces.
double behind_all(double z_m) {
  return std::isnan(z_m) ? kInfinity : z_m;
}

/// What a pixel may be: from the least to the greatest of several pictures.
template <class Pixel>
struct Span {
  Image<Pixel> low, high;

  explicit Span(const Image<Pixel>& first) : low(first), high(first) {}
  void include(const Image<Pixel>& other) {
    for (std::size_t i = 0; i < low.pixels.size(); ++i) {
      low.pixels[i] = glm::min(low.pixels[i], other.pixels[i]);
      high.pixels[i] = glm::max(high.pixels[i], other.pixels[i]);
    }
  }
  void include_all() {
    low.pixels.assign(low.pixels.size(), Pixel(-kInfinity));
    high.pixels.assign(high.pixels.size(), Pixel(kInfinity));
  }
};

/// The reference's pictures of pass 2, z of no surface at infinity, and their spans for settings
/// within the rounding of their own.
struct CastSpans {
  render::reference::Cast cast;
  Span<double> depths;
  Span<glm::dvec3> volumes;
};

/// Settings with what the detector compares moved by its bound, and with the picture and, as a box
/// moves with it, where its rays begin, moved by that of a position along an axis of the probe
/// frame.
CastSpans cast_spans(SliceStack slices, const RenderOptions& options, const PassBounds& bounds) {
  const double level = slices.level();
  const auto cast = [&](double threshold_by, int axis, double by_m) {
    RenderOptions moved = options;
    moved.ray_casting.threshold += threshold_by;
    moved.volume_of_interest.center_m[axis] += by_m;
    slices.set_level(level + threshold_by);
    render::reference::Cast pictures = cast_rays(slices, moved);
    for (double& z : pictures.depth_m.pixels) z = behind_all(z);
    return pictures;
  };
  const render::reference::Cast own = cast(0, 0, 0);
  CastSpans spans{own, Span(own.depth_m), Span(own.volume)};
  if (!std::isfinite(bounds.detector)) {
    spans.depths.include_all();
    spans.volumes.include_all();
    return spans;
  }
  for (const double threshold_by : {0.0, -bounds.detector, bounds.detector}) {
    for (const double by_m : {0.0, -bounds.cone_m, bounds.cone_m}) {
      for (int axis = 0; axis < (by_m == 0 ? 1 : 3); ++axis) {
        const render::reference::Cast moved = cast(threshold_by, axis, by_m);
        spans.depths.include(moved.depth_m);
        spans.volumes.include(moved.volume);
      }
    }
  }
  return spans;
}

/// Adds a difference to a pass. What is not finite is outside.
void count(PassError& error, double difference, double bound) {
  ++error.compared;
  if (!(difference <= bound)) ++error.outside;
  if (!(difference <= error.worst)) error.worst = difference;
  error.bound = std::max(error.bound, bound);
}

PassError slice_error(const render::VolumeSlices& made, const SliceStack& expected, double bound) {
  PassError error{"scan conversion"};
  for (int frame = 0; frame < static_cast<int>(made.slices.size()); ++frame) {
    const Image<float>& slice = made.slices[static_cast<std::size_t>(frame)];
    for (int row = 0; row < slice.height; ++row) {
      for (int column = 0; column < slice.width; ++column) {
        const double value =
            expected.pixel(frame, made.pixels.column + column, made.pixels.row + row);
        count(error, std::abs(double{slice.at(column, row)} - value), bound);
      }
    }
  }
  return error;
}

PassError cast_error(const Image<float>& cast_m, const CastSpans& spans, double beside_m) {
  PassError error{"ray casting, z"};
  for (std::size_t i = 0; i < cast_m.pixels.size(); ++i) {
    const double z_m = behind_all(double{cast_m.pixels[i]});
    const double expected_m = spans.cast.depth_m.pixels[i];
    const double low_m = spans.depths.low.pixels[i] - beside_m,
                 high_m = spans.depths.high.pixels[i] + beside_m;
    ++error.compared;
    if (!(z_m >= low_m && z_m <= high_m)) ++error.outside;
    if (std::isinf(z_m) || std::isinf(expected_m)) continue;
    error.worst = std::max(error.worst, std::abs(z_m - expected_m) / expected_m);
    const double farther_m = std::isinf(high_m) ? 0 : high_m - expected_m;
    error.bound = std::max(error.bound, std::max(farther_m, expected_m - low_m) / expected_m);
  }
  return error;
}

/// Colours against spans; each pixel may lie beyond by a bound of its own.
PassError colour_error(const std::string& pass,
                       const Image<glm::vec3>& colours,
                       const Image<glm::dvec3>& expected,
                       const Span<glm::dvec3>& spans,
                       const std::function<double(int, int)>& bound_of) {
  PassError error{pass};
  for (std::size_t i = 0; i < colours.pixels.size(); ++i) {
    const auto width = static_cast<std::size_t>(colours.width);
    const glm::dvec3 allowed(bound_of(static_cast<int>(i % width), static_cast<int>(i / width)));
    const glm::dvec3 got = colours.pixels[i], value = expected.pixels[i];
    const glm::dvec3 low = spans.low.pixels[i] - allowed, high = spans.high.pixels[i] + allowed;
    ++error.compared;
    bool within = true;
    for (int c = 0; c < 3; ++c) {
      within = within && got[c] >= low[c] && got[c] <= high[c];
      error.worst = std::max(error.worst, std::abs(got[c] - value[c]));
      const double bound = std::max(high[c] - value[c], value[c] - low[c]);
      error.bound = std::max(error.bound, std::min(bound, 1.0));
    }
    if (!within) ++error.outside;
  }
  return error;
}

/// z against z, each with a bound relative to itself.
PassError depth_error(const std::string& pass,
                      const Image<float>& depth_m,
                      const Image<double>& expected_m,
                      const std::function<double(int, int)>& bound_of) {
  PassError error{pass};
  for (int row = 0; row < depth_m.height; ++row) {
    for (int column = 0; column < depth_m.width; ++column) {
      const double z_m = expected_m.at(column, row), got_m = depth_m.at(column, row);
      if (std::isnan(z_m) && std::isnan(got_m)) continue;
      count(error, std::abs(got_m - z_m) / z_m, bound_of(column, row));
    }
  }
  return error;
}

PassError incidence_error(const render::CastDepth& depth,
                          const hw::AcquisitionPlan& plan,
                          const RenderOptions& options,
                          const PassBounds& bounds) {
  const auto cast_m = converted<double>(depth.cast_m);
  const auto found_m = render::reference::correct_incidence(cast_m, plan, options);
  const auto expected_m = render::finished_surface(found_m, plan.geometry(), options);
  const hw::BeamWidths beam(plan);
  double longest_m = 0;
  for (const hw::BeamWidth& width : beam.rows()) {
    const hw::BeamWidth length = render::correction_length(options.ray_casting, width);
    longest_m = std::max({longest_m, length.lateral_m, length.elevation_m});
  }
  const int window = normal_window(options);
  const auto filtered_m = render::reference::filter_depth(cast_m, window);
  return depth_error("incidence", depth.depth_m, expected_m, [&](int column, int row) {
    const double z_m = expected_m.at(column, row);
    const SurfaceBounds surface(
        filtered_m, options, bounds.position_m + window_bound(window) * z_m);
    if (std::isnan(found_m.at(column, row)))
      return kContinued * (longest_m * render::kMaxTangent / z_m + 4 * kUnitRoundoff);
    // Below its greatest value a tangent has a slope of at most 10.
    const double turn = std::min(10 * surface.normal(column, row), render::kMaxTangent);
    return longest_m * turn / z_m + 4 * kUnitRoundoff;
  });
}

/// Settings with the light turned by as much as moves a shadow by `position_m` within a pixel, and
/// with its bias changed by that much.
std::vector<RenderOptions> moved_lights(const RenderOptions& options, double position_m) {
  const double turn_rad = std::min(position_m / make_camera(options).pixel_m(), 0.1);
  std::vector<RenderOptions> moved;
  for (const double side : {-1.0, 1.0}) {
    moved.insert(moved.end(), 3, options);
    const auto last = moved.rbegin();
    last[0].shading.light_left_rad += side * turn_rad;
    last[1].shading.light_up_rad += side * turn_rad;
    last[2].shading.shadow_bias_m += side * position_m;
  }
  return moved;
}

PassError shading_error(const PassPictures& pictures,
                        const RenderOptions& options,
                        double position_m) {
  const auto depth_m = converted<double>(pictures.picture.filtered_depth_m);
  const auto volume = converted<glm::dvec3>(pictures.picture.volume);
  const auto expected = render::reference::shade(depth_m, volume, options);
  Span<glm::dvec3> spans(expected);
  if (options.shading.shadows) {
    for (const RenderOptions& moved : moved_lights(options, position_m)) {
      spans.include(render::reference::shade(depth_m, volume, moved));
    }
  }
  const SurfaceBounds surface(depth_m, options, position_m);
  return colour_error("shading", pictures.shaded, expected, spans, [&](int column, int row) {
    return std::isnan(depth_m.at(column, row)) ? 0.0 : surface.colour(column, row);
  });
}

}  // namespace

PassPictures run_passes(const hw::PolarVolume& volume,
                        const RenderOptions& options,
                        render::GlContext& context) {
  PassPictures pictures;
  render::RenderTaps taps;
  taps.slices = [&](const render::VolumeSlices& slices) { pictures.slices = slices; };
  taps.depth = [&](const render::CastDepth& depth) {
    pictures.depth = depth;
    return std::nullopt;
  };
  taps.shaded = [&](const Image<glm::vec3>& shaded) { pictures.shaded = shaded; };
  render::Renderer renderer(context, volume.plan(), options);
  renderer.set_taps(taps);
  renderer.add_volume(volume);
  pictures.picture = renderer.render();
  return pictures;
}

std::vector<PassError> pass_errors(const PassPictures& pictures,
                                   const hw::PolarVolume& meant,
                                   const RenderOptions& options) {
  const SliceStack slices(meant, options);
  const PassBounds bounds = pass_bounds(meant.plan(), slices, options);
  const CastSpans spans = cast_spans(slices, options, bounds);
  const Image<double> blended = blend_bounds(slices, options, bounds);
  const auto filtered_m = render::reference::filter_depth(converted<double>(pictures.depth.depth_m),
                                                          options.shading.depth_filter_size);
  const auto smoothed =
      render::reference::smooth(converted<glm::dvec3>(pictures.shaded), options.smoothing);
  const auto same = [](double bound) { return [bound](int, int) { return bound; }; };
  return {
      slice_error(pictures.slices, slices, bounds.slices),
      cast_error(pictures.depth.cast_m, spans, bounds.depth_m),
      colour_error("ray casting, volume",
                   pictures.picture.volume,
                   spans.cast.volume,
                   spans.volumes,
                   [&](int column, int row) { return blended.at(column, row); }),
      incidence_error(pictures.depth, meant.plan(), options, bounds),
      depth_error("z filter",
                  pictures.picture.filtered_depth_m,
                  filtered_m,
                  same(window_bound(options.shading.depth_filter_size))),
      shading_error(pictures, options, bounds.position_m),
      colour_error("smoothing",
                   pictures.picture.surface,
                   smoothed,
                   Span(smoothed),
                   same(smoothing_bound(options.smoothing))),
  };
}

}  // namespace wobblebench::bench
