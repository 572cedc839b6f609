#include "bench/studies/extremes/pass_bounds.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

#include "base/units.h"
#include "render/camera.h"
#include "render/geometry/ray_sampling.h"
#include "render/geometry/slice_geometry.h"
#include "render/geometry/slice_kernel.h"
#include "render/passes/incidence_correction.h"

namespace wobblebench::bench {

namespace {

constexpr double u = kUnitRoundoff;

/// Mesa's atan is a polynomial whose leading coefficient is 0.99998; to 2^-15 of the angle.
constexpr double kArcTangent = 1.0 / (1 << 15);

/// Half a step of 2^-18.
constexpr double kGridRounding = 1.0 / (1 << 19);

/// Most that a ray through the whole field is long, in far ends of the sticks.
constexpr double kFieldLength = 6;

/// Rounded to half a level when a frame is uploaded, after the filter of rows, and as a slice.
double texel_error(render::TextureFormat format) {
  if (format == render::TextureFormat::r32f) return 0;
  const double slice = format == render::TextureFormat::r8 ? 255 : 65535;
  return 0.5 / 65535 + 2 * 0.5 / slice;
}

/// Greatest coordinate that the arithmetic of a ray meets.
double extent_m(const render::RenderOptions& options, const render::SliceGeometry& geometry) {
  const render::Camera camera = make_camera(options);
  const bool parallel = camera.projection == render::Projection::parallel;
  const double before_m = parallel ? camera.plane_distance_m : camera.eye_distance_m;
  const double behind_m =
      options.ray_casting.stop_at_box ? camera.plane_distance_m : 3 * geometry.r_max_m();
  return glm::length(camera.center) + camera.width_m + before_m + behind_m;
}

/// Distances from the motor's axis of what rays sample.
struct Arms {
  double least_m = 0, most_m = 0;
};
Arms arms(const render::RenderOptions& options, const render::SliceGeometry& geometry) {
  const double axis_m = geometry.axis_z_m();
  const double in_cone_m = geometry.depth_min_m() - axis_m;
  const glm::dvec3 center = options.volume_of_interest.center_m,
                   half = 0.5 * options.volume_of_interest.size_m;
  const double y_m = std::max(std::abs(center.y) - half.y, 0.0);
  const double z_m = std::max(std::abs(center.z - axis_m) - half.z, 0.0);
  const double in_box_m = options.ray_casting.stop_at_box ? std::hypot(y_m, z_m) : 0.0;
  return {std::max({in_cone_m, in_box_m, 0.0}), geometry.r_max_m() - axis_m};
}

/// Of the motor angle: of the position; in mode plain of the table, bilinear between
/// kMotionTableSize entries a side (h^2 / 8 times the second derivatives, at most 1 / arm^2), in
/// mode fast of the arc tangent.
double angle_error(const render::RenderOptions& options,
                   const render::SliceGeometry& geometry,
                   const Arms& arms,
                   double position_m) {
  if (arms.least_m <= 0) return std::numeric_limits<double>::infinity();
  const double widest = std::max(-geometry.phi_min_rad(), geometry.phi_max_rad());
  const double of_position = position_m / arms.least_m;
  if (options.pipeline.mode == render::PipelineMode::fast) {
    return of_position + kArcTangent * widest + 4 * u;
  }
  const double entry_m = 2 * arms.most_m / (render::kMotionTableSize - 1) * 1.01;
  const double rounded_m = 4 * u * render::kMotionTableSize * entry_m;
  return (rounded_m + 2 * entry_m * entry_m / 8 / arms.least_m) / arms.least_m + of_position;
}

/// Samples enter running sums as multiples of 2^-18, whose sums are exact (edge_detector.glsl).
double detector_error(const render::RenderOptions& options, double sample) {
  const double summed = sample + kGridRounding;
  switch (options.ray_casting.detector) {
    case render::Detector::iso:
      return sample + 2 * u;
    case render::Detector::floor:  // a sum divided, at both ends
      return 2 * (summed + 2 * u);
    case render::Detector::paper:
      break;
  }
  return render::buffer_samples(options) * summed;
}

/// Places of samples are stored rounded and scaled to texels, 8 operations; then the taps' sums.
double slice_error(const hw::AcquisitionPlan& plan,
                   const render::RenderOptions& options,
                   const Steepness& steep) {
  const auto taps = static_cast<double>(slice_weights(options).size());
  const hw::AcquisitionOptions dense = dense_plan(plan, dense_factors(plan, options)).acquisition();
  return texel_error(options.scan_conversion.format) +
         8 * u * (dense.samples_per_stick * steep.sample + dense.sticks_per_frame * steep.line) +
         (taps * taps + 8) * u;
}

/// Of a fetch from the slices beside their own error: of its place in each direction, scaled to
/// texels, and of the sum of a kernel's taps along the ray.
double sample_error(const hw::AcquisitionPlan& plan,
                    const render::RenderOptions& options,
                    const Steepness& steep,
                    const PassBounds& bounds,
                    double angle) {
  const render::DenseFactors factors = dense_factors(plan, options);
  const render::SliceGeometry geometry(plan, options.scan_conversion.slice_size, factors);
  const double size = geometry.slice_size(), frames = geometry.frames();
  const double row_m = (geometry.r_max_m() - geometry.depth_min_m()) / size;
  const double column_m = 2 * geometry.x_max_m() / size;
  const double per_rad = frames > 1 ? factors.frames / std::abs(plan.phi_step_rad()) : 0;
  const int taps = ray_kernel_size(options.ray_casting) + options.ray_casting.window_2d;
  double error = steep.column * (bounds.position_m / column_m + 8 * u * size) +
                 steep.row * (bounds.place_m / row_m + 8 * u * size) + (std::pow(taps, 3) + 8) * u;
  if (steep.frame > 0) error += steep.frame * (per_rad * angle + 8 * u * frames);
  return error;
}

/// A sum over a square window.
double window_error(int filter_size) {
  return (1.0 * filter_size * filter_size + 8) * u;
}

double smoothing_error(const render::SmoothingOptions& o) {
  const double window = 2 * window_error(o.filter_size);
  switch (o.filter) {
    case render::SmoothingFilter::guided:  // variance / (variance + sigma^2), slope 1 / sigma^2
      return std::min(1.0, window * (1 + 3 / (o.range_sigma * o.range_sigma)));
    case render::SmoothingFilter::bilateral:
      // exp(-E) is wrong by E exp(-E) < 1 roundings of E, and by those of the contrast in E.
      return window + 32 * u + 8 * u / o.range_sigma;
    case render::SmoothingFilter::box:
      break;
  }
  return window;
}

}  // namespace

Steepness steepness(const hw::PolarVolume& volume,
                    const render::reference::SliceStack& slices,
                    const render::RenderOptions& options) {
  Steepness found;
  const auto sticks = render::reference::make_sticks(volume, options);
  const auto length = static_cast<std::size_t>(volume.plan().acquisition().samples_per_stick);
  const auto raise = [](double& most, double a, double b) {
    most = std::max(most, std::abs(a - b));
  };
  for (const auto& frame : sticks.frames) {
    for (std::size_t i = 0; i < frame.size(); ++i) {
      if (i % length != 0) raise(found.sample, frame[i], frame[i - 1]);
      if (i >= length) raise(found.line, frame[i], frame[i - length]);
    }
  }
  const int size = slices.geometry().slice_size();
  for (int f = 0; f < slices.geometry().frames(); ++f) {
    for (int row = 0; row < size; ++row) {
      for (int column = 0; column < size; ++column) {
        const double here = slices.pixel(f, column, row);
        if (column > 0) raise(found.column, here, slices.pixel(f, column - 1, row));
        if (row > 0) raise(found.row, here, slices.pixel(f, column, row - 1));
        if (f > 0) raise(found.frame, here, slices.pixel(f - 1, column, row));
      }
    }
  }
  return found;
}

PassBounds pass_bounds(const hw::AcquisitionPlan& plan,
                       const render::RenderOptions& options,
                       const Steepness& steep) {
  const render::SliceGeometry geometry(
      plan, options.scan_conversion.slice_size, dense_factors(plan, options));
  PassBounds bounds;
  // A position: origin, offset and length along the ray, 8 operations.
  bounds.position_m = 8 * u * extent_m(options, geometry);
  const Arms arm = arms(options, geometry);
  const double angle = angle_error(options, geometry, arm, bounds.position_m);
  bounds.place_m = bounds.position_m + (std::isfinite(angle) ? angle * arm.most_m : 0);
  bounds.slices = slice_error(plan, options, steep);
  bounds.sample = bounds.slices + sample_error(plan, options, steep, bounds, angle);
  const double ray_m = options.ray_casting.stop_at_box
                           ? glm::length(options.volume_of_interest.size_m)
                           : kFieldLength * geometry.r_max_m();
  bounds.detector = detector_error(options, bounds.sample);
  bounds.step_error_m = bounds.position_m + 8 * u * ray_m;
  bounds.filter = window_error(options.shading.depth_filter_size);
  bounds.smoothing = smoothing_error(options.smoothing);
  return bounds;
}

}  // namespace wobblebench::bench
