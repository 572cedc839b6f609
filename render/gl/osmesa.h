// OSMesa: Mesa's software rasteriser drawing to memory. Loaded when asked for, so that programs
// start without it. (Mesa 25.1 removed OSMesa; the backend then says that it is missing.)
#pragma once

#include <memory>

#include "render/gl/context.h"

namespace wobblebench::render {

/// Throws std::runtime_error when libOSMesa is missing or gives no OpenGL 4.5 core context.
std::unique_ptr<GlContext> make_osmesa_context();

}  // namespace wobblebench::render
