#include "bench/studies/extremes/pass_errors.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "bench/studies/extremes/blend_bounds.h"
#include "bench/studies/extremes/cast_spans.h"
#include "bench/studies/extremes/surface_bounds.h"
#include "render/passes/incidence_correction.h"

namespace wobblebench::bench {

namespace {

using render::reference::SliceStack;

Image<double> in_double(const Image<float>& image) {
  Image<double> converted(image.width, image.height);
  std::copy(image.pixels.begin(), image.pixels.end(), converted.pixels.begin());
  return converted;
}

Image<glm::dvec3> in_double(const Image<glm::vec3>& image) {
  Image<glm::dvec3> converted(image.width, image.height);
  std::copy(image.pixels.begin(), image.pixels.end(), converted.pixels.begin());
  return converted;
}

/// Adds a difference to a pass. What is not finite is outside.
void count(PassError& error, double difference, double bound) {
  ++error.compared;
  if (!(difference <= bound)) ++error.outside;
  if (!(difference <= error.worst)) error.worst = difference;
  error.bound = std::max(error.bound, bound);
}

PassError slice_error(const PassPictures& pictures, const SliceStack& expected, double bound) {
  PassError error{"scan conversion"};
  const render::Region& region = pictures.pixels;
  for (int frame = 0; frame < static_cast<int>(pictures.slices.size()); ++frame) {
    const Image<float>& slice = pictures.slices[static_cast<std::size_t>(frame)];
    for (int row = 0; row < slice.height; ++row) {
      for (int column = 0; column < slice.width; ++column) {
        const double value = expected.pixel(frame, region.column + column, region.row + row);
        count(error, std::abs(double{slice.at(column, row)} - value), bound);
      }
    }
  }
  return error;
}

/// How far a value lies outside a span, and the span's half width.
PassError cast_error(const Image<float>& cast_m, const CastSpans& spans, const PassBounds& bounds) {
  PassError error{"ray casting, z"};
  for (std::size_t i = 0; i < cast_m.pixels.size(); ++i) {
    const double z_m = as_span(double{cast_m.pixels[i]}), expected_m = spans.depth_m.pixels[i];
    const double low_m = spans.depths.low(i) - bounds.step_error_m,
                 high_m = spans.depths.high(i) + bounds.step_error_m;
    ++error.compared;
    if (!(z_m >= low_m && z_m <= high_m)) ++error.outside;
    if (std::isinf(z_m) || std::isnan(expected_m)) continue;
    error.worst = std::max(error.worst, std::abs(z_m - expected_m) / expected_m);
    const double farther_m = std::isinf(high_m) ? 0 : high_m - expected_m;
    error.bound = std::max(error.bound, std::max(farther_m, expected_m - low_m) / expected_m);
  }
  return error;
}

/// Colours against spans, each pixel with an error of its own.
PassError colour_error(const std::string& pass,
                       const Image<glm::vec3>& colours,
                       const Image<glm::dvec3>& expected,
                       const PixelSpans<glm::dvec3>& spans,
                       const std::function<double(std::size_t)>& bound_of) {
  PassError error{pass};
  for (std::size_t i = 0; i < colours.pixels.size(); ++i) {
    const double allowed = bound_of(i);
    double worst = 0, bound = 0;
    bool within = true;
    for (int c = 0; c < 3; ++c) {
      const double got = colours.pixels[i][c], value = expected.pixels[i][c];
      const double low = spans.low(i)[c] - allowed, high = spans.high(i)[c] + allowed;
      within = within && got >= low && got <= high;
      worst = std::max(worst, std::abs(got - value));
      bound = std::max({bound, high - value, value - low});
    }
    ++error.compared;
    if (!within) ++error.outside;
    error.worst = std::max(error.worst, worst);
    error.bound = std::max(error.bound, std::min(bound, 1.0));
  }
  return error;
}

PassError incidence_error(const PassPictures& pictures,
                          const hw::ProbeGeometry& geometry,
                          const render::RenderOptions& options,
                          const PassBounds& bounds) {
  PassError error{"incidence"};
  const Image<double> cast_m = in_double(pictures.cast_m);
  const auto expected = render::reference::correct_incidence(cast_m, geometry, options);
  const int window = normal_window(options);
  const auto filtered = render::reference::filter_depth(cast_m, window);
  const double filter = (1.0 * window * window + 8) * kUnitRoundoff;
  for (int row = 0; row < cast_m.height; ++row) {
    for (int column = 0; column < cast_m.width; ++column) {
      const double z_m = expected.at(column, row);
      const double got_m = pictures.corrected_m.at(column, row);
      if (std::isnan(z_m) && std::isnan(got_m)) continue;
      const SurfaceBounds surface(filtered, options, bounds.position_m + filter * z_m);
      // tan has the slope 1 + tan^2 / cos-like factors of at most 10 below its greatest value.
      const double turn = 10 * surface.normal(column, row);
      const double most = std::min(turn, render::kMaxTangent);
      const double allowed_m =
          options.ray_casting.incidence_correction_m * most + 4 * kUnitRoundoff * z_m;
      count(error, std::abs(got_m - z_m) / z_m, allowed_m / z_m);
    }
  }
  return error;
}

PassError filter_error(const PassPictures& pictures,
                       const render::RenderOptions& options,
                       double bound) {
  PassError error{"z filter"};
  const auto expected = render::reference::filter_depth(in_double(pictures.corrected_m),
                                                        options.shading.depth_filter_size);
  for (std::size_t i = 0; i < expected.pixels.size(); ++i) {
    const double z_m = expected.pixels[i], got_m = pictures.filtered_m.pixels[i];
    if (std::isnan(z_m) && std::isnan(got_m)) continue;
    count(error, std::abs(got_m - z_m) / z_m, bound);
  }
  return error;
}

PassError shading_error(const PassPictures& pictures,
                        const render::RenderOptions& options,
                        const PassBounds& bounds) {
  const Image<double> depth_m = in_double(pictures.filtered_m);
  const Image<glm::dvec3> rendered = in_double(pictures.volume);
  const auto expected = render::reference::shade(depth_m, rendered, options);
  PixelSpans<glm::dvec3> spans(expected);
  if (options.shading.shadows) {
    for (const auto& moved : moved_lights(options, bounds.position_m)) {
      spans.include(render::reference::shade(depth_m, rendered, moved));
    }
  }
  const SurfaceBounds surface(depth_m, options, bounds.position_m);
  return colour_error("shading", pictures.shaded, expected, spans, [&](std::size_t i) {
    if (std::isnan(depth_m.pixels[i])) return 0.0;
    const auto width = static_cast<std::size_t>(depth_m.width);
    return surface.colour(static_cast<int>(i % width), static_cast<int>(i / width));
  });
}

}  // namespace

std::vector<PassError> pass_errors(const PassPictures& pictures,
                                   const hw::PolarVolume& meant,
                                   const render::RenderOptions& options) {
  const SliceStack slices(meant, options);
  const PassBounds bounds = pass_bounds(meant.plan(), options, steepness(meant, slices, options));
  const Image<double> blended = blend_bounds(slices, options, bounds);
  const auto volume_error = [&](const CastSpans& spans) {
    return colour_error(
        "ray casting, volume", pictures.volume, spans.volume, spans.volumes, [&](std::size_t i) {
          return blended.pixels[i];
        });
  };
  const auto within = [&](const CastSpans& spans) {
    return cast_error(pictures.cast_m, spans, bounds).outside == 0 &&
           volume_error(spans).outside == 0;
  };
  const CastSpans spans = cast_spans(slices, meant, options, bounds, pictures.levels, within);
  const auto same = [](double bound) { return [bound](std::size_t) { return bound; }; };
  std::vector<PassError> errors = {slice_error(pictures, slices, bounds.slices),
                                   cast_error(pictures.cast_m, spans, bounds),
                                   volume_error(spans)};
  errors.push_back(incidence_error(pictures, meant.plan().geometry(), options, bounds));
  errors.push_back(filter_error(pictures, options, bounds.filter));
  errors.push_back(shading_error(pictures, options, bounds));
  const auto smoothed = render::reference::smooth(in_double(pictures.shaded), options.smoothing);
  errors.push_back(colour_error("smoothing",
                                pictures.smoothed,
                                smoothed,
                                PixelSpans<glm::dvec3>(smoothed),
                                same(bounds.smoothing)));
  return errors;
}

}  // namespace wobblebench::bench
