// One GL context for all tests of the program.
#pragma once

#include "render/gl/context.h"

namespace wobblebench::render::testing {

/// Current on the calling thread.
GlContext& gl_context();

}  // namespace wobblebench::render::testing
