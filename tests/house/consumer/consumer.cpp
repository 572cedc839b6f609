// Takes a volume from our plan and renders it with our reference.
#include <cstdio>

#include "wobblebench/hw/probe/polar_volume.h"
#include "wobblebench/render/reference/reference.h"

int main() {
  using namespace wobblebench;
  hw::AcquisitionOptions acquisition;
  acquisition.frames_per_volume = 3;
  acquisition.sticks_per_frame = 3;
  acquisition.samples_per_stick = 16;
  const hw::PolarVolume volume(hw::AcquisitionPlan({}, acquisition));
  render::RenderOptions options;
  options.scan_conversion.slice_size = 16;
  options.ray_casting.image_size = 4;
  options.ray_casting.steps = 16;
  const auto picture = render::render_reference(volume, options);
  std::printf("%zu pixels\n", picture.depth_m.pixels.size());
  return picture.depth_m.pixels.size() == 16 ? 0 : 1;
}
