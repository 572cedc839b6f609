// Kernel weights, sample counts and transfer function of pass 2, and how its 3D kernel splits into
// filters of slices, of frames, and along the ray: computed on the CPU for the GL passes and the
// double-precision reference.
#pragma once

#include <vector>

#include "render/options.h"

namespace wobblebench::render {

/// Normalised Gaussian of `size` taps, one step apart, standard deviation size / 4 steps (0.75 for
/// 3, 1.25 for 5). The 3D kernel is its threefold product.
std::vector<double> gaussian_weights(int size);

/// Weights convolved with a normalised box of `box` taps.
std::vector<double> convolved_with_box(const std::vector<double>& weights, int box);

/// Taps across the ray for the sample that enters the buffer of Eq. (1): the Gaussian of
/// ray_kernel_size() taps, averaged over a window of `window_2d`. Length kernel + window - 1, sum
/// 1.
std::vector<double> buffer_weights(const RayCastingOptions& options);

/// Taps across the ray for the sample that is blended: the Gaussian, with zeros at both ends up to
/// the length of buffer_weights().
std::vector<double> blend_weights(const RayCastingOptions& options);

/// n of Eq. (1), from `buffer_length` or `buffer_length_m`.
int buffer_samples(const RenderOptions& options);

/// Threshold on Difference of Eq. (1), the sum of the newer half of the buffer minus that of the
/// older half: from `threshold` or `threshold_per_sample`.
double difference_threshold(const RenderOptions& options);

/// Samples up to this one that the detector takes to say whether the surface lies here: n of
/// Eq. (1); two for an iso-surface; for Detector::floor those of the floor's blocks and of one
/// more, because the crossing is interpolated from the step before.
int detector_samples(const RenderOptions& options);

/// Detector::floor: samples in the mean of a millimetre, at least 1 and at most 64.
int floor_mean_samples(const RenderOptions& options);
/// Detector::floor: finished blocks of floor_mean_samples(), whose least mean is the floor with
/// that of the block that is not finished.
inline constexpr int kFloorBlocks = 11;

/// Largest distance of a kernel tap from its position on the ray.
double kernel_radius_m(const RenderOptions& options);

/// Grey level and opacity of a sample, piecewise linear over the options' lists, constant beyond.
class TransferFunction {
 public:
  TransferFunction(const RayCastingOptions& options, double step_m);

  double grey(double value) const;
  /// Opacity of one step: 1 - (1 - opacity per mm) ^ (step in mm).
  double step_opacity(double value) const;
  /// `size` pairs of grey and step opacity over values 0 to 1, both ends included.
  std::vector<float> table(int size) const;

 private:
  std::vector<double> values_, opacity_per_mm_, grey_;
  double step_m_;
};

/// Entries of the transfer function's texture.
inline constexpr int kTransferTableSize = 4096;

/// Taps within a slice, along each axis: pass 1's box, convolved with the Gaussian of the 3D kernel
/// if that lies in slices. Odd length, sum 1. A pixel of a slice is the mean of the pixels around
/// it that hold data, weighted by the product of the taps of both axes.
std::vector<double> slice_weights(const RenderOptions& options);

/// Taps across frames: the Gaussian of the 3D kernel if that lies in slices, else a single 1. Taps
/// beyond the first and last frame carry no weight.
std::vector<double> frame_weights(const RayCastingOptions& options);

/// Taps per side of the 3D kernel in ray space; 1: none.
int ray_kernel_size(const RayCastingOptions& options);

}  // namespace wobblebench::render
