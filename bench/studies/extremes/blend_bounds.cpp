#include "bench/studies/extremes/blend_bounds.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "render/camera.h"
#include "render/geometry/ray_sampling.h"
#include "render/geometry/slice_kernel.h"

namespace wobblebench::bench {

namespace {

/// Opacity and grey level over samples within a bound of each entry of the shader's table.
class WrongTransfer {
 public:
  WrongTransfer(const render::RenderOptions& options, double sample)
      : transfer_(options.ray_casting, step_m(options)),
        // Linear interpolation of the table reads from up to an entry away.
        reach_(std::min(sample + 1.0 / (render::kTransferTableSize - 1), 1.0)) {}

  struct Entry {
    double opacity, opacity_error, grey_error;
  };
  Entry at(double value) const {
    constexpr int kParts = 8;
    Entry entry{transfer_.step_opacity(value), 0, 0};
    const double grey = transfer_.grey(value);
    for (int i = -kParts; i <= kParts; ++i) {
      const double near = value + reach_ * i / kParts;
      entry.opacity_error =
          std::max(entry.opacity_error, std::abs(transfer_.step_opacity(near) - entry.opacity));
      entry.grey_error = std::max(entry.grey_error, std::abs(transfer_.grey(near) - grey));
    }
    return entry;
  }

 private:
  render::TransferFunction transfer_;
  double reach_;
};

class RayBound {
 public:
  RayBound(const render::reference::SliceStack& slices,
           const render::RenderOptions& options,
           const PassBounds& bounds)
      : slices_(slices),
        o_(options.ray_casting),
        box_(options.volume_of_interest),
        camera_(make_camera(options)),
        step_m_(step_m(options)),
        transfer_(options, bounds.sample) {
    if (!o_.stop_at_box) box_ = field_box(slices.geometry());
    start_ = options.volume_of_interest;
  }

  double of(int column, int row) const {
    const hw::Ray ray = camera_.ray(column, row);
    const render::Span span = clip_to_box(ray, start_);
    const double end_m = clip_to_box(ray, box_).to_m;
    double error = 0, opacity = 0, most_light = 1;
    for (int step = 0;; ++step) {
      const double at_m = span.from_m + (step + 0.5) * step_m_;
      if (at_m >= end_m + step_m_) break;
      const auto sample = slices_.at(ray.at(at_m));
      if (!sample.inside) continue;
      const auto entry = transfer_.at(sample.value);
      error +=
          most_light * (entry.opacity_error + entry.opacity * entry.grey_error + 4 * kUnitRoundoff);
      most_light *= 1 - std::max(entry.opacity - entry.opacity_error, 0.0);
      opacity += (1 - opacity) * entry.opacity;
      if (std::abs(opacity - o_.opacity_limit) <= error) error += most_light;
      if (opacity >= o_.opacity_limit) break;
    }
    return std::min(error, 1.0);
  }

 private:
  const render::reference::SliceStack& slices_;
  const render::RayCastingOptions& o_;
  render::VolumeOfInterest box_, start_;
  render::Camera camera_;
  double step_m_;
  WrongTransfer transfer_;
};

}  // namespace

Image<double> blend_bounds(const render::reference::SliceStack& slices,
                           const render::RenderOptions& options,
                           const PassBounds& bounds) {
  const int size = options.ray_casting.image_size;
  Image<double> errors(size, size, 1.0);
  const render::RayCastingOptions& o = options.ray_casting;
  // A kernel along the ray mixes samples that are not followed here.
  if (ray_kernel_size(o) > 1 || !std::isfinite(bounds.sample)) return errors;
  if (o.mode == render::RenderMode::surface) return Image<double>(size, size, 0.0);
  const RayBound ray(slices, options, bounds);
  for (int row = 0; row < size; ++row) {
    for (int column = 0; column < size; ++column) errors.at(column, row) = ray.of(column, row);
  }
  return errors;
}

}  // namespace wobblebench::bench
