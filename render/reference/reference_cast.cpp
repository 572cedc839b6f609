// Pass 2 of the reference. An edge becomes z in a SurfaceFinder.
#include <algorithm>
#include <cmath>
#include <deque>
#include <glm/geometric.hpp>
#include <limits>
#include <memory>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

#include "base/parallel.h"
#include "render/camera.h"
#include "render/geometry/ray_sampling.h"
#include "render/reference/reference_passes.h"

namespace wobblebench::render::reference {
namespace {

/// Finds the surface along one ray.
class SurfaceFinder {
 public:
  virtual ~SurfaceFinder() = default;
  SurfaceFinder() = default;
  SurfaceFinder(const SurfaceFinder&) = delete;
  SurfaceFinder& operator=(const SurfaceFinder&) = delete;

  /// The ray is outside the cone.
  virtual void reset() = 0;
  /// Adds the sample at this ray length; returns z if it completes an edge.
  virtual std::optional<double> take(double sample, double distance_m) = 0;
};

double sign_of(EdgeSign edge) {
  return edge == EdgeSign::rising ? 1 : -1;
}

/// Difference of Eq. (1): the newer half of the buffer minus the older half; negated for falling
/// edges.
class PaperFinder : public SurfaceFinder {
 public:
  explicit PaperFinder(const RenderOptions& options)
      : o_(options.ray_casting),
        threshold_(difference_threshold(options)),
        step_m_(step_m(options)),
        n_(static_cast<std::size_t>(buffer_samples(options))) {}

  void reset() override {
    buffer_.clear();
    last_difference_.reset();
  }
  std::optional<double> take(double sample, double distance_m) override {
    buffer_.push_back(sample);
    if (buffer_.size() < n_) return {};
    if (buffer_.size() > n_) buffer_.pop_front();
    const double now = difference();
    const std::optional<double> before = std::exchange(last_difference_, now);
    if (now < threshold_) return {};
    if (!o_.refine_crossing || !before) return distance_m;
    return distance_m - step_m_ * (now - threshold_) / (now - *before);
  }

 private:
  double difference() const {
    const auto middle = buffer_.begin() + static_cast<std::ptrdiff_t>(buffer_.size() / 2);
    const double older = std::accumulate(buffer_.begin(), middle, 0.0);
    const double newer = std::accumulate(middle, buffer_.end(), 0.0);
    return sign_of(o_.edge) * (newer - older);
  }

  RayCastingOptions o_;
  double threshold_;
  double step_m_;
  std::size_t n_;
  std::deque<double> buffer_;
  std::optional<double> last_difference_;
};

/// An iso-surface.
class IsoFinder : public SurfaceFinder {
 public:
  IsoFinder(const RayCastingOptions& options, double step_m, double level)
      : o_(options), step_m_(step_m), level_(level) {}

  void reset() override {
    last_.reset();
    at_start_ = false;
  }
  std::optional<double> take(double sample, double distance_m) override {
    const double now = sign_of(o_.edge) * (sample - level_);
    const std::optional<double> before = std::exchange(last_, now);
    if (o_.caps && !at_start_ && !before && now >= 0) return distance_m;
    at_start_ = false;
    if (!before || *before >= 0 || now < 0) return {};
    return o_.refine_crossing ? distance_m - step_m_ * now / (now - *before) : distance_m;
  }

 private:
  RayCastingOptions o_;
  double step_m_, level_;
  bool at_start_ = true;        ///< of the ray
  std::optional<double> last_;  ///< how far beyond the level the sample before was
};

/// A rise of the mean over a millimetre above the least such mean of the last eleven.
class FloorFinder : public SurfaceFinder {
 public:
  FloorFinder(const RenderOptions& options, double rise)
      : o_(options.ray_casting),
        step_m_(step_m(options)),
        samples_(floor_mean_samples(options)),
        rise_(rise) {}

  void reset() override {
    buffer_.clear();
    means_.push_back(kNoMean);
    std::ranges::fill(means_, kNoMean);
    last_rise_ = 0;
  }
  std::optional<double> take(double sample, double distance_m) override {
    means_.push_back(kNoMean);
    buffer_.push_back(sample);
    if (buffer_.size() < static_cast<std::size_t>(samples_)) return {};
    if (buffer_.size() > static_cast<std::size_t>(samples_)) buffer_.pop_front();
    means_.back() =
        sign_of(o_.edge) * std::accumulate(buffer_.begin(), buffer_.end(), 0.0) / samples_;
    const double now = means_.back() - floor();
    const double before = std::exchange(last_rise_, now);
    if (now < rise_) return {};
    const double middle_m = distance_m - 0.5 * (samples_ - 1) * step_m_;
    return o_.refine_crossing ? middle_m - step_m_ * (now - rise_) / (now - before) : middle_m;
  }

 private:
  static constexpr double kNoMean = std::numeric_limits<double>::infinity();

  /// The least mean of the block of `samples_` steps that the last one belongs to, and of the
  /// kFloorBlocks blocks before; blocks are counted from the ray's first step.
  double floor() const {
    const auto blocks_before = (means_.size() - 1) / static_cast<std::size_t>(samples_);
    const auto first = blocks_before - std::min<std::size_t>(blocks_before, kFloorBlocks);
    const auto begin = static_cast<std::ptrdiff_t>(first) * samples_;
    return *std::min_element(means_.begin() + begin, means_.end());
  }

  RayCastingOptions o_;
  double step_m_;
  int samples_;
  double rise_;
  std::deque<double> buffer_;
  std::vector<double> means_;  ///< of each step; none before the cone and its first millimetre
  double last_rise_ = 0;
};

/// Of RayCastingOptions::detector. `level`: detection_level() of the volume.
std::unique_ptr<SurfaceFinder> make_surface_finder(const RenderOptions& options, double level) {
  switch (options.ray_casting.detector) {
    case Detector::iso:
      return std::make_unique<IsoFinder>(options.ray_casting, step_m(options), level);
    case Detector::floor:
      return std::make_unique<FloorFinder>(options, level);
    case Detector::paper:
      break;
  }
  return std::make_unique<PaperFinder>(options);
}

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
