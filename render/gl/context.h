// An OpenGL context without a window.
#pragma once

#include <memory>
#include <string>
#include <vector>

namespace wobblebench::render {

/// Interface of the backends that provide OpenGL. The table of GL entry points is one per process:
/// contexts of several backends may exist at once, and calls go to the one that was made current
/// last, but they must not be used on two threads at the same time. A context is destroyed on the
/// thread that made it current.
///
/// @code
/// std::unique_ptr<render::GlContext> context = render::make_context("egl");
/// const std::string driver = context->renderer_string();
/// const auto other = render::make_context("osmesa");  // now current
/// context->make_current();
/// @endcode
class GlContext {
 public:
  virtual ~GlContext() = default;
  GlContext() = default;
  GlContext(const GlContext&) = delete;
  GlContext& operator=(const GlContext&) = delete;

  /// Makes it this thread's current context, in place of one of any backend, and loads GL's entry
  /// points if the backend changes (a third of a millisecond). Throws std::runtime_error.
  void make_current();
  /// Address of a GL function.
  virtual void* proc_address(const char* name) const = 0;
  /// Name that make_context takes.
  virtual std::string backend() const = 0;
  /// GL_RENDERER and GL_VERSION, valid after make_current().
  std::string renderer_string() const;

 protected:
  /// Leaves the thread without a context if this one is current. Destructors call it first.
  void release();

 private:
  virtual void bind() = 0;
  virtual void unbind() = 0;
};

/// Backends that make_context takes in this build:
///   osmesa      Mesa's software rasteriser, drawing to memory
///   egl         EGL without a surface, on the GPU that Mesa finds, or in software
///   egl-device  EGL on the first device that gives a context, hardware before software
std::vector<std::string> context_backends();

/// Creates a context and makes it current. Throws std::runtime_error that lists the backends, or
/// says what the machine lacks and what to install.
[[nodiscard]] std::unique_ptr<GlContext> make_context(const std::string& backend = "osmesa");

}  // namespace wobblebench::render
