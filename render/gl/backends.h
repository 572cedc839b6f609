// What a backend implements: a context of its driver, without window and surface. libEGL and
// libOSMesa are loaded on first use, so that programs start without them.
#pragma once

#include <atomic>
#include <memory>
#include <string>

#include "render/gl/context.h"
#include "render/gl/program.h"

namespace wobblebench::render {

/// A driver's context. A thread on which it is current shares its ownership
/// (render/gl/context.cpp), so that it is destroyed only where, and when, no thread has it current.
class DriverContext {
 public:
  virtual ~DriverContext() = default;
  DriverContext() = default;
  DriverContext(const DriverContext&) = delete;
  DriverContext& operator=(const DriverContext&) = delete;

  /// Makes it this thread's current context. Throws std::runtime_error; ContextLost.
  virtual void bind() = 0;
  /// Leaves this thread without a context.
  virtual void unbind() = 0;
  /// Address of a GL function.
  virtual void* proc_address(const char* name) const = 0;
  /// Name that make_context takes.
  virtual std::string backend() const = 0;

  std::atomic<bool> is_current{false};  ///< on some thread
  const std::shared_ptr<ProgramPool> programs = std::make_shared<ProgramPool>();
};

/// "egl": EGL_MESA_platform_surfaceless. Throws std::runtime_error that says what is missing.
[[nodiscard]] std::unique_ptr<GlContext> make_surfaceless_context();

/// "egl-device": EGL_EXT_platform_device, on the first device that gives an OpenGL 4.5 core
/// context, hardware before software. Throws std::runtime_error with each device and its reason.
[[nodiscard]] std::unique_ptr<GlContext> make_device_context();

/// "osmesa": Mesa's software rasteriser drawing to memory (Mesa 25.1 removed it). Throws
/// std::runtime_error when libOSMesa is missing or gives no OpenGL 4.5 core context.
[[nodiscard]] std::unique_ptr<GlContext> make_osmesa_context();

}  // namespace wobblebench::render
