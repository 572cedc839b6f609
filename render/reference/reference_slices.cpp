// Pass 1 of the reference.
#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "render/geometry/slice_kernel.h"
#include "render/reference/reference_passes.h"

namespace wobblebench::render::reference {
namespace {

/// Value of a pixel without data.
constexpr double kEmpty = std::numeric_limits<double>::quiet_NaN();

double sample_at(const std::vector<double>& frame, int samples_per_stick, int line, int sample) {
  return frame[static_cast<std::size_t>(line) * static_cast<std::size_t>(samples_per_stick) +
               static_cast<std::size_t>(sample)];
}

/// Bilinear in line and sample.
double interpolate(const std::vector<double>& frame,
                   const hw::AcquisitionOptions& acquisition,
                   const SliceGeometry::PolarIndex& index) {
  const int samples = acquisition.samples_per_stick;
  const int line = static_cast<int>(index.line), sample = static_cast<int>(index.sample);
  const int next_line = std::min(line + 1, acquisition.sticks_per_frame - 1);
  const int next_sample = std::min(sample + 1, samples - 1);
  const double along = index.sample - sample, across = index.line - line;
  return std::lerp(std::lerp(sample_at(frame, samples, line, sample),
                             sample_at(frame, samples, line, next_sample),
                             along),
                   std::lerp(sample_at(frame, samples, next_line, sample),
                             sample_at(frame, samples, next_line, next_sample),
                             along),
                   across);
}

Image<double> scan_convert(const std::vector<double>& frame,
                           const hw::AcquisitionOptions& acquisition,
                           const SliceGeometry& geometry) {
  const int size = geometry.slice_size();
  Image<double> slice(size, size, kEmpty);
  for (int row = 0; row < size; ++row) {
    for (int column = 0; column < size; ++column) {
      const auto index =
          geometry.polar_index(geometry.pixel_x_m(column), geometry.pixel_depth_m(row));
      if (index.inside) slice.at(column, row) = interpolate(frame, acquisition, index);
    }
  }
  return slice;
}

/// Mean of the pixels with data around a pixel, weighted by the product of the taps of both axes; 0
/// if there are none.
double mean_around(const Image<double>& slice,
                   int column,
                   int row,
                   const std::vector<double>& weights) {
  const int half = static_cast<int>(weights.size()) / 2;
  double sum = 0, total = 0;
  for (int j = -half; j <= half; ++j) {
    for (int i = -half; i <= half; ++i) {
      const int x = column + i, y = row + j;
      if (x < 0 || y < 0 || x >= slice.width || y >= slice.height) continue;
      if (std::isnan(slice.at(x, y))) continue;
      const double weight =
          weights[static_cast<std::size_t>(i + half)] * weights[static_cast<std::size_t>(j + half)];
      sum += weight * slice.at(x, y);
      total += weight;
    }
  }
  return total > 0 ? sum / total : 0;
}

Image<double> filter(const Image<double>& slice, const std::vector<double>& weights) {
  // Pixels next to the sector take the mean of their neighbours in it, also without a filter.
  const std::vector<double> next_to_sector =
      weights.size() > 1 ? weights : std::vector<double>(3, 1.0 / 3);
  Image<double> filtered(slice.width, slice.height);
  for (int row = 0; row < slice.height; ++row) {
    for (int column = 0; column < slice.width; ++column) {
      const bool is_empty = std::isnan(slice.at(column, row));
      filtered.at(column, row) =
          mean_around(slice, column, row, is_empty ? next_to_sector : weights);
    }
  }
  return filtered;
}

/// Weighted mean of a slice and its neighbours, as far as they exist.
Image<double> across_frames(const std::vector<Image<double>>& slices,
                            int frame,
                            const std::vector<double>& weights) {
  const int half = static_cast<int>(weights.size()) / 2;
  Image<double> mean(slices.front().width, slices.front().height);
  double total = 0;
  for (int offset = -half; offset <= half; ++offset) {
    const int neighbour = frame + offset;
    if (neighbour < 0 || neighbour >= static_cast<int>(slices.size())) continue;
    const double weight = weights[static_cast<std::size_t>(offset + half)];
    const auto& pixels = slices[static_cast<std::size_t>(neighbour)].pixels;
    for (std::size_t i = 0; i < pixels.size(); ++i) mean.pixels[i] += weight * pixels[i];
    total += weight;
  }
  for (double& pixel : mean.pixels) pixel /= total;
  return mean;
}

/// A fractional pixel or frame as two neighbours and the weight of the second, clamped to the edge.
struct Between {
  int first, second;
  double weight;
};
Between between(double at, int count) {
  const double clamped = std::clamp(at, 0.0, count - 1.0);
  const int first = static_cast<int>(clamped);
  return {first, std::min(first + 1, count - 1), clamped - first};
}

}  // namespace

SliceStack::SliceStack(const hw::PolarVolume& volume, const RenderOptions& options)
    : geometry_(
          volume.plan(), options.scan_conversion.slice_size, dense_factors(volume.plan(), options)),
      sweep_(volume.plan().sweep_direction(volume.volume_index())),
      slices_(static_cast<std::size_t>(geometry_.frames())) {
  const ReferenceSticks sticks = make_sticks(volume, options);
  level_ = sticks.level;
  const hw::AcquisitionPlan plan = dense_plan(volume.plan(), dense_factors(volume.plan(), options));
  std::vector<Image<double>> filtered(slices_.size());
  parallel_rows(geometry_.frames(), [&](int frame) {
    filtered[static_cast<std::size_t>(frame)] = filter(
        scan_convert(sticks.frames[static_cast<std::size_t>(frame)], plan.acquisition(), geometry_),
        slice_weights(options));
  });
  parallel_rows(geometry_.frames(), [&](int frame) {
    slices_[static_cast<std::size_t>(frame)] =
        across_frames(filtered, frame, frame_weights(options.ray_casting));
  });
}

SliceStack::Sample SliceStack::at(const glm::dvec3& position_m) const {
  const SlicePoint point = geometry_.locate(position_m, sweep_);
  if (!point.inside) return {};
  const int size = geometry_.slice_size();
  const Between x = between(geometry_.column(point.x_m), size);
  const Between y = between(geometry_.row(point.depth_m), size);
  const Between f = between(point.frame, geometry_.frames());
  const auto in_slice = [&](int frame) {
    return std::lerp(
        std::lerp(pixel(frame, x.first, y.first), pixel(frame, x.second, y.first), x.weight),
        std::lerp(pixel(frame, x.first, y.second), pixel(frame, x.second, y.second), x.weight),
        y.weight);
  };
  return {std::lerp(in_slice(f.first), in_slice(f.second), f.weight), true};
}

}  // namespace wobblebench::render::reference
