#include "render/geometry/slice_kernel.h"

#include "render/geometry/ray_sampling.h"

namespace wobblebench::render {
namespace {

bool in_slices(const RayCastingOptions& options) {
  return options.kernel_space == KernelSpace::slice;
}

}  // namespace

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
