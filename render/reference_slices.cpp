#include <algorithm>
#include <cmath>

#include "render/reference_passes.h"
#include "render/rows.h"
#include "render/scan_converter.h"

namespace wobblebench::render::reference {
namespace {

/// A pixel of a slice without data.
constexpr double kEmpty = std::numeric_limits<double>::quiet_NaN();

double sample_at(const hw::PolarFrame& frame, int samples_per_stick, int line, int sample) {
  return clean_sample(
      frame.samples[static_cast<std::size_t>(line) * static_cast<std::size_t>(samples_per_stick) +
                    static_cast<std::size_t>(sample)]);
}

/// Bilinear in line and sample.
double interpolate(const hw::PolarFrame& frame,
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

Image<double> scan_convert(const hw::PolarFrame& frame,
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

/// Mean of the pixels with data in a window; 0 if there are none.
double mean_around(const Image<double>& slice, int column, int row, int half_size) {
  double sum = 0, count = 0;
  for (int j = std::max(row - half_size, 0); j <= std::min(row + half_size, slice.height - 1);
       ++j) {
    for (int i = std::max(column - half_size, 0);
         i <= std::min(column + half_size, slice.width - 1);
         ++i) {
      if (std::isnan(slice.at(i, j))) continue;
      sum += slice.at(i, j);
      ++count;
    }
  }
  return count > 0 ? sum / count : 0;
}

Image<double> filter(const Image<double>& slice, int filter_size) {
  Image<double> filtered(slice.width, slice.height);
  for (int row = 0; row < slice.height; ++row) {
    for (int column = 0; column < slice.width; ++column) {
      // Pixels next to the sector take their neighbours' mean.
      const bool is_empty = std::isnan(slice.at(column, row));
      const int half_size = is_empty ? std::max(filter_size / 2, 1) : filter_size / 2;
      filtered.at(column, row) = mean_around(slice, column, row, half_size);
    }
  }
  return filtered;
}

/// A fractional pixel or frame as two neighbours and the share of the second, clamped to the edge.
struct Between {
  int first, second;
  double share;
};
Between between(double at, int count) {
  const double clamped = std::clamp(at, 0.0, count - 1.0);
  const int first = static_cast<int>(clamped);
  return {first, std::min(first + 1, count - 1), clamped - first};
}

}  // namespace

SliceStack::SliceStack(const hw::PolarVolume& volume, const ScanConversionOptions& options)
    : geometry_(volume.plan(), options.slice_size), slices_(volume.frames().size()) {
  for_each_row(geometry_.frames(), [&](int frame) {
    slices_[static_cast<std::size_t>(frame)] =
        filter(scan_convert(volume.frame(frame), volume.plan().acquisition(), geometry_),
               options.filter_size);
  });
}

SliceStack::Sample SliceStack::at(const glm::dvec3& position_m) const {
  const SlicePoint point = geometry_.locate(position_m);
  if (!point.inside) return {};
  const int size = geometry_.slice_size();
  const Between x = between(geometry_.column(point.across_m), size);
  const Between y = between(geometry_.row(point.depth_m), size);
  const Between f = between(point.frame, geometry_.frames());
  const auto in_slice = [&](int frame) {
    return std::lerp(
        std::lerp(pixel(frame, x.first, y.first), pixel(frame, x.second, y.first), x.share),
        std::lerp(pixel(frame, x.first, y.second), pixel(frame, x.second, y.second), x.share),
        y.share);
  };
  return {std::lerp(in_slice(f.first), in_slice(f.second), f.share), true};
}

}  // namespace wobblebench::render::reference
