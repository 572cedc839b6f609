// An OpenGL context without a window.
#pragma once

#include <memory>
#include <string>
#include <vector>

namespace wobblebench::render {

/// What keeps the rest of the renderer ignorant of where OpenGL comes from. GL's entry points are
/// one table for the process: contexts of several backends may live side by side, and each call
/// goes to the one that was made current last, but they may not be used on two threads at once.
class GlContext {
 public:
  virtual ~GlContext() = default;
  GlContext() = default;
  GlContext(const GlContext&) = delete;
  GlContext& operator=(const GlContext&) = delete;

  /// Makes it this thread's current context, in place of one of any backend, and loads GL through
  /// it where the backend changes (a third of a millisecond). Throws std::runtime_error.
  void make_current();
  virtual void* proc_address(const char* name) const = 0;
  /// As make_context takes it.
  virtual std::string backend() const = 0;
  /// GL_RENDERER and GL_VERSION, valid after make_current().
  std::string renderer_string() const;

 protected:
  /// Leaves the thread without a context if this one is current. A destructor calls it first.
  void release();

 private:
  virtual void bind() = 0;
  virtual void unbind() = 0;
};

/// Names that make_context takes in this build:
///   osmesa      Mesa's software rasteriser, drawing to memory
///   egl         EGL without a surface, on the GPU that Mesa finds, or in software
///   egl-device  EGL on the first device that gives a context, hardware before software
std::vector<std::string> context_backends();

/// Makes the context and makes it current. Throws std::runtime_error that says which backends
/// exist, or what the machine lacks and what to install.
std::unique_ptr<GlContext> make_context(const std::string& backend = "osmesa");

}  // namespace wobblebench::render
