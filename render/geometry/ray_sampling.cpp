#include "render/geometry/ray_sampling.h"

#include <algorithm>
#include <cmath>

#include "render/camera.h"

namespace wobblebench::render {
namespace {

double interpolate(const std::vector<double>& x, const std::vector<double>& y, double at) {
  if (at <= x.front()) return y.front();
  for (std::size_t i = 1; i < x.size(); ++i) {
    if (at < x[i]) return std::lerp(y[i - 1], y[i], (at - x[i - 1]) / (x[i] - x[i - 1]));
  }
  return y.back();
}

bool in_slices(const RayCastingOptions& options) {
  return options.kernel_space == KernelSpace::slice;
}

/// Nothing is buffered where no surface is sought.
int window(const RayCastingOptions& options) {
  return options.mode == RenderMode::volume ? 1 : options.window_2d;
}

}  // namespace

std::vector<double> gaussian_weights(int size) {
  const double sigma = size / 4.0;
  std::vector<double> weights;
  double sum = 0;
  for (int tap = 0; tap < size; ++tap) {
    const int offset = tap - (size - 1) / 2;
    weights.push_back(std::exp(-0.5 * offset * offset / (sigma * sigma)));
    sum += weights.back();
  }
  for (double& weight : weights) weight /= sum;
  return weights;
}

std::vector<double> convolved_with_box(const std::vector<double>& weights, int box) {
  std::vector<double> mean(weights.size() + static_cast<std::size_t>(box) - 1, 0.0);
  for (std::size_t shift = 0; shift < static_cast<std::size_t>(box); ++shift) {
    for (std::size_t tap = 0; tap < weights.size(); ++tap) mean[shift + tap] += weights[tap] / box;
  }
  return mean;
}

std::vector<double> buffer_weights(const RayCastingOptions& options) {
  return convolved_with_box(gaussian_weights(ray_kernel_size(options)), window(options));
}

std::vector<double> blend_weights(const RayCastingOptions& options) {
  const auto margin = static_cast<std::size_t>((window(options) - 1) / 2);
  std::vector<double> weights(margin, 0.0);
  const std::vector<double> gaussian = gaussian_weights(ray_kernel_size(options));
  weights.insert(weights.end(), gaussian.begin(), gaussian.end());
  weights.insert(weights.end(), margin, 0.0);
  return weights;
}

int buffer_samples(const RenderOptions& options) {
  const RayCastingOptions& o = options.ray_casting;
  if (o.buffer_length_m == 0) return o.buffer_length;
  return 2 * static_cast<int>(std::lround(0.5 * o.buffer_length_m / step_m(options)));
}

double difference_threshold(const RenderOptions& options) {
  const RayCastingOptions& o = options.ray_casting;
  return o.threshold_per_sample == 0 ? o.threshold
                                     : o.threshold_per_sample * 0.5 * buffer_samples(options);
}

int detector_samples(const RenderOptions& options) {
  switch (options.ray_casting.detector) {
    case Detector::iso:
      return 2;
    case Detector::floor:
      return (kFloorBlocks + 2) * floor_mean_samples(options);
    case Detector::paper:
      break;
  }
  return buffer_samples(options);
}

int floor_mean_samples(const RenderOptions& options) {
  return std::clamp(static_cast<int>(std::lround(kMillimetre / step_m(options))), 1, 64);
}

double kernel_radius_m(const RenderOptions& options) {
  const int along = ray_kernel_size(options.ray_casting) / 2;
  const std::size_t across = buffer_weights(options.ray_casting).size() / 2;
  return step_m(options) * std::hypot(double(along), double(across), double(across));
}

TransferFunction::TransferFunction(const RayCastingOptions& options, double step_m)
    : values_(options.transfer_values),
      opacity_per_mm_(options.transfer_opacity_per_mm),
      grey_(options.transfer_grey),
      step_m_(step_m) {}

double TransferFunction::grey(double value) const {
  return interpolate(values_, grey_, value);
}

double TransferFunction::step_opacity(double value) const {
  const double per_mm = interpolate(values_, opacity_per_mm_, value);
  return 1 - std::pow(1 - per_mm, step_m_ / kMillimetre);
}

std::vector<float> TransferFunction::table(int size) const {
  std::vector<float> entries;
  for (int i = 0; i < size; ++i) {
    const double value = i / (size - 1.0);
    entries.push_back(static_cast<float>(grey(value)));
    entries.push_back(static_cast<float>(step_opacity(value)));
  }
  return entries;
}

std::vector<double> slice_weights(const RenderOptions& options) {
  const int box = options.scan_conversion.filter_size;
  return convolved_with_box(frame_weights(options.ray_casting), box);
}

std::vector<double> frame_weights(const RayCastingOptions& options) {
  return gaussian_weights(in_slices(options) ? options.kernel_3d : 1);
}

int ray_kernel_size(const RayCastingOptions& options) {
  return in_slices(options) ? 1 : options.kernel_3d;
}

}  // namespace wobblebench::render
