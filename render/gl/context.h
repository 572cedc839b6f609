// An OpenGL context without a window.
#pragma once

#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

namespace wobblebench::render {

class DriverContext;

/// The context is lost, and all objects in it: the GPU was reset, or the machine suspended. A new
/// context may work. Osmesa loses none. EGL says so where the driver does (reset notification, or
/// EGL_CONTEXT_LOST from eglMakeCurrent); a driver that gives no notification may report other
/// errors, or none.
class ContextLost : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// OpenGL 4.5 core from one of several backends. The table of GL entry points is one per process:
/// contexts of several backends may exist at once, and calls go to the one that was made current
/// last, but they must not be used on two threads at the same time. A thread hands a context over
/// by release(), or by its end. A context may be destroyed on any thread: the driver's part lives
/// until the thread on which it is current leaves it.
///
/// @code
/// std::unique_ptr<render::GlContext> context = render::make_context("egl");
/// const std::string driver = context->renderer_string();
/// const auto other = render::make_context("osmesa");  // now current
/// context->make_current();
/// @endcode
class GlContext {
 public:
  explicit GlContext(std::shared_ptr<DriverContext> driver);
  ~GlContext();
  GlContext(const GlContext&) = delete;
  GlContext& operator=(const GlContext&) = delete;

  /// Makes it this thread's current context, in place of one of any backend, and loads GL's entry
  /// points if the backend changes (a third of a millisecond). Throws std::logic_error while it is
  /// current on another thread; std::runtime_error; ContextLost.
  void make_current();
  /// Leaves this thread without a context if this one is current.
  void release();
  /// Address of a GL function.
  void* proc_address(const char* name) const;
  /// Name that make_context takes; never "auto".
  std::string backend() const;
  /// GL_RENDERER and GL_VERSION, valid after make_current().
  std::string renderer_string() const;

 private:
  std::shared_ptr<DriverContext> driver_;
};

/// Backends of this build, in the order in which `auto` tries them (docs/decisions/0018):
///   osmesa      Mesa's software rasteriser, drawing to memory
///   egl         EGL without a surface, on the GPU that Mesa finds, or in software
///   egl-device  EGL on the first device that gives a context, hardware before software
std::vector<std::string> context_backends();

/// Creates a context and makes it current; "auto": of the first backend that this machine has.
/// Throws std::runtime_error that lists the backends, or says what the machine lacks and what to
/// install.
[[nodiscard]] std::unique_ptr<GlContext> make_context(const std::string& backend = "auto");

}  // namespace wobblebench::render
