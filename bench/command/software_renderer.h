// A context that renders on the CPU where a device was asked for.
#pragma once

#include <string>

#include "bench/output/progress.h"
#include "render/gl/context.h"

namespace wobblebench::bench {

/// Mesa's rasterisers that run on the CPU, by GL_RENDERER.
bool is_software(const std::string& renderer);

/// Warns where `wanted`, of --gl, is egl-device and no device but the CPU gave a context.
void warn_of_software(const render::GlContext& context,
                      const std::string& wanted,
                      Progress& progress);

}  // namespace wobblebench::bench
