// OSMesa contexts: Mesa's software rasteriser drawing to memory. libOSMesa is loaded on first use,
// so that programs start without it. (Mesa 25.1 removed OSMesa.)
#pragma once

#include <memory>

#include "render/gl/context.h"

namespace wobblebench::render {

/// Throws std::runtime_error when libOSMesa is missing or gives no OpenGL 4.5 core context.
[[nodiscard]] std::unique_ptr<GlContext> make_osmesa_context();

}  // namespace wobblebench::render
