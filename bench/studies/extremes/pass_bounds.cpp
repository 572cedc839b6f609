#include "bench/studies/extremes/pass_bounds.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <utility>

#include "render/geometry/lighting.h"
#include "render/geometry/ray_sampling.h"

namespace wobblebench::bench {

namespace {

constexpr double u = kUnitRoundoff;

/// Mesa's atan is a polynomial whose leading coefficient is 0.99998; to 2^-15 of the angle.
constexpr double kArcTangent = 1.0 / (1 << 15);
/// Samples enter running sums as multiples of 2^-18, whose sums are exact (edge_detector.glsl).
constexpr double kGridRounding = 1.0 / (1 << 19);
/// Upper bound of a ray's length in the field, in multiples of the range of the sticks' far ends.
constexpr double kFieldLength = 6;
/// Greatest distance between two unit vectors.
constexpr double kMostTurn = 2;

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

/// Least distance from the motor's axis of what rays sample: in the cone and, where they end there,
/// in the box.
double least_arm_m(const render::RenderOptions& options, const render::SliceGeometry& geometry) {
  const glm::dvec3 center = options.volume_of_interest.center_m,
                   half = 0.5 * options.volume_of_interest.size_m;
  const double y_m = std::max(std::abs(center.y) - half.y, 0.0);
  const double z_m = std::max(std::abs(center.z - geometry.axis_z_m()) - half.z, 0.0);
  const double in_box_m = options.ray_casting.stop_at_box ? std::hypot(y_m, z_m) : 0.0;
  return std::max({geometry.depth_min_m() - geometry.axis_z_m(), in_box_m, 0.0});
}

/// Error of the motor angle: from the position and, in mode plain, from the table, bilinear between
/// kMotionTableSize entries a side (h^2 / 8 times the second derivatives, at most 1 / arm^2), in
/// mode fast from the arc tangent.
double angle_error(const render::RenderOptions& options,
                   const render::SliceGeometry& geometry,
                   double position_m) {
  const double least_m = least_arm_m(options, geometry);
  if (least_m <= 0) return std::numeric_limits<double>::infinity();
  if (options.pipeline.mode == render::PipelineMode::fast) {
    const double widest = std::max(-geometry.phi_min_rad(), geometry.phi_max_rad());
    return position_m / least_m + kArcTangent * widest + 4 * u;
  }
  const double most_m = geometry.r_max_m() - geometry.axis_z_m();
  const double entry_m = 2 * most_m / (render::kMotionTableSize - 1) * 1.01;
  const double rounded_m = 4 * u * render::kMotionTableSize * entry_m;
  return (position_m + rounded_m + 2 * entry_m * entry_m / 8 / least_m) / least_m;
}

/// Greatest difference between neighbouring pixels of slices.
struct Steepness {
  double column = 0, row = 0, frame = 0;
};
Steepness steepness(const render::reference::SliceStack& slices) {
  Steepness found;
  const int size = slices.geometry().slice_size();
  for (int f = 0; f < slices.geometry().frames(); ++f) {
    for (int row = 0; row < size; ++row) {
      for (int column = 0; column < size; ++column) {
        const auto raise = [&](double& most, int frame, int c, int r) {
          const double other = slices.pixel(std::max(frame, 0), std::max(c, 0), std::max(r, 0));
          most = std::max(most, std::abs(slices.pixel(f, column, row) - other));
        };
        raise(found.column, f, column - 1, row);
        raise(found.row, f, column, row - 1);
        raise(found.frame, f - 1, column, row);
      }
    }
  }
  return found;
}

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

}  // namespace

PassBounds pass_bounds(const hw::AcquisitionPlan& plan,
                       const render::reference::SliceStack& slices,
                       const render::RenderOptions& options) {
  const render::DenseFactors factors = dense_factors(plan, options);
  const hw::AcquisitionOptions dense = dense_plan(plan, factors).acquisition();
  const render::SliceGeometry& geometry = slices.geometry();
  const Steepness steep = steepness(slices);
  const double size = geometry.slice_size(), frames = geometry.frames();
  PassBounds bounds;
  // Origin, offset and length along the ray, 8 operations.
  bounds.position_m = 8 * u * extent_m(options, geometry);
  // Line and sample are stored rounded and scaled to texels, 8 operations; then the taps' sums.
  const auto taps = static_cast<double>(slice_weights(options).size());
  bounds.slices = texel_error(options.scan_conversion.format) +
                  8 * u * (dense.samples_per_stick + dense.sticks_per_frame) +
                  (taps * taps + 8) * u;
  // A fetch: its position in the slice and across the frames, and the sum of a kernel's taps.
  const double angle = angle_error(options, geometry, bounds.position_m);
  const double arm_m = geometry.r_max_m() - geometry.axis_z_m();
  bounds.cone_m = bounds.position_m + (std::isfinite(angle) ? angle * arm_m : 0);
  const double row_m = (geometry.r_max_m() - geometry.depth_min_m()) / size;
  const double column_m = 2 * geometry.x_max_m() / size;
  const int kernel = ray_kernel_size(options.ray_casting) + options.ray_casting.window_2d;
  bounds.sample = bounds.slices + steep.column * (bounds.position_m / column_m + 8 * u * size) +
                  steep.row * (bounds.cone_m / row_m + 8 * u * size) +
                  (std::pow(kernel, 3) + 8) * u;
  if (steep.frame > 0) {
    const double per_rad = factors.frames / std::abs(plan.phi_step_rad());
    bounds.sample += steep.frame * (per_rad * angle + 8 * u * frames);
  }
  bounds.detector = detector_error(options, bounds.sample);
  const double ray_m = options.ray_casting.stop_at_box
                           ? glm::length(options.volume_of_interest.size_m)
                           : kFieldLength * geometry.r_max_m();
  bounds.depth_m = bounds.position_m + 8 * u * ray_m;
  return bounds;
}

Image<double> blend_bounds(const render::reference::SliceStack& slices,
                           const render::RenderOptions& options,
                           const PassBounds& bounds) {
  const render::RayCastingOptions& o = options.ray_casting;
  Image<double> errors(o.image_size, o.image_size, 1.0);
  // A kernel along the ray mixes samples that are not followed here.
  if (ray_kernel_size(o) > 1 || !std::isfinite(bounds.sample)) return errors;
  if (o.mode == render::RenderMode::surface) return Image<double>(o.image_size, o.image_size, 0.0);
  const render::Camera camera = make_camera(options);
  const render::VolumeOfInterest end_box =
      o.stop_at_box ? options.volume_of_interest : field_box(slices.geometry());
  const double step = step_m(options);
  const render::TransferFunction transfer(o, step);
  // Linear interpolation of the shader's table reads from up to an entry away.
  const double reach = std::min(bounds.sample + 1.0 / (render::kTransferTableSize - 1), 1.0);
  const auto change = [&](double (render::TransferFunction::*of)(double) const, double value) {
    const double here = (transfer.*of)(value);
    return std::max(std::abs((transfer.*of)(value + reach) - here),
                    std::abs((transfer.*of)(value - reach) - here));
  };
  const auto error_of = [&](const hw::Ray& ray) {
    const render::Span span = clip_to_box(ray, options.volume_of_interest);
    const double end_m = clip_to_box(ray, end_box).to_m + step;
    double error = 0, opacity = 0, most_light = 1;
    const int steps = static_cast<int>(std::ceil((end_m - span.from_m) / step - 0.5));
    for (int number = 0; number < steps; ++number) {
      const auto sample = slices.at(ray.at(span.from_m + (number + 0.5) * step));
      if (!sample.inside) continue;
      const double own = transfer.step_opacity(sample.value);
      const double own_error = change(&render::TransferFunction::step_opacity, sample.value);
      error += most_light *
               (own_error + own * change(&render::TransferFunction::grey, sample.value) + 4 * u);
      most_light *= 1 - std::max(own - own_error, 0.0);
      opacity += (1 - opacity) * own;
      if (std::abs(opacity - o.opacity_limit) <= error) error += most_light;
      if (opacity >= o.opacity_limit) break;
    }
    return std::min(error, 1.0);
  };
  for (int row = 0; row < o.image_size; ++row) {
    for (int column = 0; column < o.image_size; ++column) {
      errors.at(column, row) = error_of(camera.ray(column, row));
    }
  }
  return errors;
}

double window_bound(int filter_size) {
  return (1.0 * filter_size * filter_size + 8) * u;
}

double smoothing_bound(const render::SmoothingOptions& o) {
  const double window = 2 * window_bound(o.filter_size);
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

SurfaceBounds::SurfaceBounds(const Image<double>& depth_m,
                             const render::RenderOptions& options,
                             double position_m)
    : depth_m_(depth_m),
      options_(options),
      camera_(make_camera(options)),
      position_m_(position_m) {}

/// The product of the surface's tangents, one-sided where a neighbour is missing; `lengths_m`: the
/// sum of their lengths.
glm::dvec3 SurfaceBounds::across(int column, int row, double& lengths_m) const {
  const double here_m = depth_m_.at(column, row);
  const auto point = [&](int c, int r) {
    const bool inside = c >= 0 && r >= 0 && c < depth_m_.width && r < depth_m_.height;
    const double z_m = inside ? depth_m_.at(c, r) : kNoSurface;
    return std::pair(!std::isnan(z_m), camera_.ray(c, r).at(std::isnan(z_m) ? here_m : z_m));
  };
  const auto tangent = [&](int right, int down) {
    const auto [has_before, before] = point(column - right, row - down);
    const auto [has_after, after] = point(column + right, row + down);
    const glm::dvec3 here = camera_.ray(column, row).at(here_m);
    if (has_before == has_after) return after - before;
    return has_after ? after - here : here - before;
  };
  const glm::dvec3 one = tangent(1, 0), other = tangent(0, 1);
  lengths_m = glm::length(one) + glm::length(other);
  return glm::cross(one, other);
}

double SurfaceBounds::normal(int column, int row) const {
  double lengths_m = 0;
  const double area = glm::length(across(column, row, lengths_m));
  const double product_m2 = 2 * position_m_ * lengths_m;
  return area > product_m2 ? std::min(kMostTurn, 2 * product_m2 / area) : kMostTurn;
}

double SurfaceBounds::colour(int column, int row) const {
  const render::ShadingOptions& o = options_.shading;
  const hw::Ray ray = camera_.ray(column, row);
  const glm::dvec3 surface = ray.at(depth_m_.at(column, row));
  glm::dvec3 light = light_direction_in_probe(o, camera_);
  double of_light = 8 * u;
  if (o.light == render::Light::point) {
    const glm::dvec3 offset = light_position_in_probe_m(o, camera_) - surface;
    const double distance_m = glm::length(offset);
    of_light = std::min(kMostTurn, 2 * position_m_ / std::max(distance_m, 1e-30));
    light = distance_m > 0 ? offset / distance_m : -ray.direction;
  }
  const double turn = std::min(kMostTurn, normal(column, row) + of_light);
  const double halfway = std::max(glm::length(light - ray.direction), 1e-20);
  const double of_halfway = std::min(kMostTurn, turn + 2 * (of_light + u) / halfway);
  double lengths_m = 0;
  const glm::dvec3 away = across(column, row, lengths_m);
  const double facing = glm::dot(away, light) / std::max(glm::length(away), 1e-300);
  const bool either_side = std::abs(facing) <= turn;  // of the light: with a highlight or without
  const double highlight = either_side ? 1.0 : std::min(1.0, o.shininess * of_halfway);
  const double base = std::max({o.base_rgb.x, o.base_rgb.y, o.base_rgb.z});
  return 16 * u * (1 + o.shininess) + base * o.diffuse * turn + o.specular * highlight;
}

}  // namespace wobblebench::bench
