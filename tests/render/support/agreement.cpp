#include "tests/render/support/agreement.h"

#include <gtest/gtest.h>

#include "render/camera.h"
#include "render/renderer.h"
#include "tests/render/support/gl_fixture.h"
#include "tests/render/support/synthetic.h"

namespace wobblebench::render::testing {

int expect_same(const Picture& got,
                const Picture& expected,
                const Bounds& bounds,
                const RenderOptions& options) {
  const auto depth = compare(got.depth_m, expected.depth_m);
  EXPECT_LE(depth.rms_m, bounds.z_rms_steps * step_m(options));
  EXPECT_LE(depth.changed_share, bounds.changed_share);
  const auto filtered = compare(got.filtered_depth_m, expected.filtered_depth_m);
  EXPECT_LE(filtered.rms_m, bounds.z_rms_steps * step_m(options));
  const auto surface = compare(got.surface, expected.surface, 0.01);
  EXPECT_LE(surface.failing_share, bounds.surface_share)
      << "largest difference " << surface.largest;
  const auto blended = compare(got.volume, expected.volume, 0.005);
  EXPECT_LE(blended.failing_share, bounds.blended_share)
      << "largest difference " << blended.largest;
  return depth.both;
}

Picture rendered(const hw::PolarVolume& volume, RenderOptions options, PipelineMode mode) {
  options.pipeline.mode = mode;
  return render_volume(gl_context(), volume, options);
}

void expect_same_bits(const Picture& got, const Picture& expected) {
  EXPECT_TRUE(same_bits(got.depth_m, expected.depth_m));
  EXPECT_TRUE(same_bits(got.filtered_depth_m, expected.filtered_depth_m));
  EXPECT_TRUE(same_bits(got.surface, expected.surface));
  EXPECT_TRUE(same_bits(got.volume, expected.volume));
}

}  // namespace wobblebench::render::testing
