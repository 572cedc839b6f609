#include "bench/studies/extremes/sample_reach.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "render/camera.h"
#include "render/geometry/ray_sampling.h"
#include "render/geometry/slice_geometry.h"
#include "render/geometry/slice_kernel.h"
#include "render/reconstruction/reconstruction.h"

namespace wobblebench::bench {

namespace {

/// A spline takes the second neighbours; an edge counts by the eight around it, whose own are two
/// sticks away from theirs at most.
constexpr int kAlignedReach = 5;

/// Around a sample, in lines, samples and frames of the scan.
struct Around {
  double line = 1, sample = 1, frame = 1;
};

class Reach {
 public:
  Reach(const hw::AcquisitionPlan& plan,
        const render::RenderOptions& options,
        const ChangedSample& changed)
      : geometry_(plan, options.scan_conversion.slice_size), changed_(changed) {
    const auto half = [](std::size_t taps) { return static_cast<double>(taps) / 2; };
    // Half of the filter and the pixel beyond it that interpolation reads.
    pixels_ = half(slice_weights(options).size()) + 1;
    around_.frame += half(frame_weights(options.ray_casting).size());
    if (options.reconstruction.sticks == render::Sticks::aligned) {
      around_.line = around_.frame = kAlignedReach;
      around_.sample = plan.acquisition().samples_per_stick;
    }
  }

  bool has(const glm::dvec3& position_m) const {
    const render::SlicePoint point = geometry_.locate(position_m);
    if (std::abs(point.frame - changed_.stick.frame) > around_.frame) return false;
    const double column = geometry_.column(point.x_m), row = geometry_.row(point.depth_m);
    const auto here = index(column, row);
    double lines = 0, samples = 0;  // that the slice's pixels around lie away
    for (const double right : {-pixels_, pixels_}) {
      for (const double down : {-pixels_, pixels_}) {
        const auto corner = index(column + right, row + down);
        lines = std::max(lines, std::abs(corner.line - here.line));
        samples = std::max(samples, std::abs(corner.sample - here.sample));
      }
    }
    return std::abs(here.line - changed_.stick.line) <= around_.line + lines &&
           std::abs(here.sample - changed_.sample) <= around_.sample + samples;
  }

 private:
  render::SliceGeometry::PolarIndex index(double column, double row) const {
    return geometry_.polar_index(geometry_.pixel_x_m(column), geometry_.pixel_depth_m(row));
  }

  render::SliceGeometry geometry_;
  ChangedSample changed_;
  Around around_;
  double pixels_;
};

}  // namespace

std::vector<bool> reached_pixels(const hw::AcquisitionPlan& plan,
                                 const render::RenderOptions& options,
                                 const ChangedSample& changed) {
  const render::Camera camera = make_camera(options);
  const Reach reach(plan, options, changed);
  const double half_step_m = 0.5 * step_m(options);
  std::vector<bool> reached;
  for (int row = 0; row < camera.image_size; ++row) {
    for (int column = 0; column < camera.image_size; ++column) {
      const hw::Ray ray = camera.ray(column, row);
      const render::Span span = clip_to_box(ray, options.volume_of_interest);
      bool found = false;
      for (double at_m = span.from_m; at_m <= span.to_m && !found; at_m += half_step_m) {
        found = reach.has(ray.at(at_m));
      }
      reached.push_back(found);
    }
  }
  return reached;
}

long changed_out_of_reach(const std::vector<bool>& reached,
                          const Image<float>& before_m,
                          const Image<float>& after_m,
                          const render::RenderOptions& options) {
  const double allowed_m = needs_levels(options) ? 0.01 * step_m(options) : 0;
  long changed = 0;
  for (std::size_t i = 0; i < reached.size(); ++i) {
    const double before = before_m.pixels[i], after = after_m.pixels[i];
    if (reached[i] || (std::isnan(before) && std::isnan(after))) continue;
    if (!(std::abs(after - before) <= allowed_m)) ++changed;
  }
  return changed;
}

}  // namespace wobblebench::bench
