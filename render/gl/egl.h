// EGL contexts without window and surface: all drawing goes to framebuffer objects. libEGL is
// loaded on first use, so that programs start without it.
#pragma once

#include <memory>

#include "render/gl/context.h"

namespace wobblebench::render {

/// "egl": EGL_MESA_platform_surfaceless. Throws std::runtime_error that says what is missing.
[[nodiscard]] std::unique_ptr<GlContext> make_surfaceless_context();

/// "egl-device": EGL_EXT_platform_device, on the first device that gives an OpenGL 4.5 core
/// context, hardware before software. Throws std::runtime_error with each device and its reason.
[[nodiscard]] std::unique_ptr<GlContext> make_device_context();

}  // namespace wobblebench::render
