// Pass 2 of the reference. An edge becomes z in reference_detectors.cpp.
#include <cmath>
#include <glm/geometric.hpp>
#include <optional>

#include "base/parallel.h"
#include "render/geometry/ray_sampling.h"
#include "render/geometry/slice_kernel.h"
#include "render/reference/reference_detectors.h"
#include "render/reference/reference_passes.h"

namespace wobblebench::render::reference {
namespace {

/// Smoothed samples at one position of a ray.
struct RaySample {
  double buffered;  ///< for the buffer of Eq. (1)
  double blended;   ///< for alpha blending
};

/// One step along a ray and two across it.
struct RayAxes {
  glm::dvec3 along, across_1, across_2;
};

class RayTracer {
 public:
  RayTracer(const SliceStack& slices, const RenderOptions& options)
      : slices_(slices),
        options_(options),
        o_(options_.ray_casting),
        camera_(make_camera(options)),
        end_box_(o_.stop_at_box ? options.volume_of_interest : field_box(slices.geometry())),
        step_m_(step_m(options)),
        transfer_(o_, step_m_),
        along_weights_(gaussian_weights(ray_kernel_size(o_))),
        buffer_weights_(buffer_weights(o_)),
        blend_weights_(blend_weights(o_)) {}

  struct Pixel {
    double depth_m = kNoSurface;
    glm::dvec3 color{0};
  };
  Pixel trace(int column, int row) const;

 private:
  /// Empty outside the cone.
  std::optional<RaySample> smoothed(const glm::dvec3& position, const RayAxes& axes) const;
  RayAxes axes(const hw::Ray& ray) const;
  double smooth_across(const glm::dvec3& position,
                       const RayAxes& axes,
                       const std::vector<double>& across_weights) const;

  const SliceStack& slices_;
  const RenderOptions& options_;
  const RayCastingOptions& o_;
  Camera camera_;
  VolumeOfInterest end_box_;
  double step_m_;
  TransferFunction transfer_;
  std::vector<double> along_weights_, buffer_weights_, blend_weights_;
};

RayAxes RayTracer::axes(const hw::Ray& ray) const {
  const glm::dvec3 across_1 = glm::normalize(glm::cross(camera_.down, ray.direction));
  const glm::dvec3 across_2 = glm::cross(ray.direction, across_1);
  return {step_m_ * ray.direction, step_m_ * across_1, step_m_ * across_2};
}

/// The 3D kernel in ray space, over the taps inside the cone.
double RayTracer::smooth_across(const glm::dvec3& position,
                                const RayAxes& axes,
                                const std::vector<double>& across_weights) const {
  const int along_half = static_cast<int>(along_weights_.size()) / 2;
  const int across_half = static_cast<int>(across_weights.size()) / 2;
  double sum = 0, total = 0;
  for (int k = -along_half; k <= along_half; ++k) {
    for (int j = -across_half; j <= across_half; ++j) {
      for (int i = -across_half; i <= across_half; ++i) {
        const double weight = along_weights_.at(static_cast<std::size_t>(k + along_half)) *
                              across_weights.at(static_cast<std::size_t>(i + across_half)) *
                              across_weights.at(static_cast<std::size_t>(j + across_half));
        if (weight == 0) continue;
        const auto tap = slices_.at(position + double(k) * axes.along + double(i) * axes.across_1 +
                                    double(j) * axes.across_2);
        if (!tap.inside) continue;
        sum += weight * tap.value;
        total += weight;
      }
    }
  }
  return sum / total;
}

std::optional<RaySample> RayTracer::smoothed(const glm::dvec3& position,
                                             const RayAxes& axes) const {
  if (!slices_.at(position).inside) return {};
  RaySample sample{};
  if (o_.mode != RenderMode::volume)
    sample.buffered = smooth_across(position, axes, buffer_weights_);
  if (o_.mode != RenderMode::surface)
    sample.blended = smooth_across(position, axes, blend_weights_);
  return sample;
}

RayTracer::Pixel RayTracer::trace(int column, int row) const {
  const hw::Ray ray = camera_.ray(column, row);
  const Span span = clip_to_box(ray, options_.volume_of_interest);
  Pixel pixel;
  if (span.to_m < span.from_m) return pixel;
  const double end_m = clip_to_box(ray, end_box_).to_m;
  const RayAxes ray_axes = axes(ray);

  const auto finder = make_surface_finder(options_, slices_.level());
  bool finding = o_.mode != RenderMode::volume, blending = o_.mode != RenderMode::surface;
  bool was_inside = false;
  double opacity = 0;
  const int count = static_cast<int>(std::floor((end_m - span.from_m) / step_m_ + 0.5));
  for (int i = 0; i < count && (finding || blending); ++i) {
    const double distance_m = span.from_m + (i + 0.5) * step_m_;
    const auto sample = smoothed(ray.at(distance_m), ray_axes);
    if (!sample) {
      if (was_inside && o_.stop_on_leaving_cone) break;
      finder->reset();
      continue;
    }
    was_inside = true;
    if (finding) {
      if (const auto z_m = finder->take(sample->buffered, distance_m)) {
        pixel.depth_m = *z_m;
        finding = false;
        if (o_.mode == RenderMode::surface) break;
      }
    }
    if (blending) {  // front to back
      const double weight = (1 - opacity) * transfer_.step_opacity(sample->blended);
      pixel.color += glm::dvec3(weight * transfer_.grey(sample->blended));
      opacity += weight;
      blending = opacity < o_.opacity_limit;
    }
  }
  return pixel;
}

}  // namespace

Cast cast_rays(const SliceStack& slices, const RenderOptions& options) {
  const int size = options.ray_casting.image_size;
  const RayTracer tracer(slices, options);
  Cast cast{Image<double>(size, size), Image<glm::dvec3>(size, size)};
  parallel_rows(size, [&](int row) {
    for (int column = 0; column < size; ++column) {
      const auto pixel = tracer.trace(column, row);
      cast.depth_m.at(column, row) = pixel.depth_m;
      cast.volume.at(column, row) = pixel.color;
    }
  });
  return cast;
}

}  // namespace wobblebench::render::reference
