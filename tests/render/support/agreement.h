// Whether two pictures agree.
#pragma once

#include "hw/probe/polar_volume.h"
#include "render/options.h"
#include "render/picture.h"

namespace wobblebench::render::testing {

/// How far two pictures may be from each other.
struct Bounds {
  double z_rms_steps = 0.1;
  double changed_share = 0.001;  ///< of pixels with a surface in only one
  double blended_share = 0.005;  ///< of pixels more than 0.005 off in the volume picture
  double surface_share = 0.01;   ///< of pixels more than 0.01 off in the surface picture
};

/// Returns how many pixels have a surface in both.
int expect_same(const Picture& got,
                const Picture& expected,
                const Bounds& bounds,
                const RenderOptions& options);

/// In this mode of the pipeline.
Picture rendered(const hw::PolarVolume& volume, RenderOptions options, PipelineMode mode);

/// To the bit, all images of both.
void expect_same_bits(const Picture& got, const Picture& expected);

}  // namespace wobblebench::render::testing
