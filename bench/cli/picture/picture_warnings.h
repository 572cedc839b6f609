// What may be wrong with a picture although nothing failed: no surface, or another one.
#pragma once

#include <string>
#include <vector>

#include "bench/evaluation/measures/depth_error.h"
#include "bench/scene/resolved_scene.h"
#include "render/picture.h"

namespace wobblebench::bench {

/// One line for each: no surface in the picture, and which stage lost it; the near field of the
/// probe in it; with `error`, against the truth, a surface where the phantom has none, or one in
/// front of the true one. `error`: null: the truth is not known. Empty in mode "volume".
std::vector<std::string> picture_warnings(const render::Picture& picture,
                                          const ResolvedScene& scene,
                                          const DepthError* error);

}  // namespace wobblebench::bench
