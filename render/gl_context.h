// An OpenGL context without a window.
#pragma once

#include <memory>
#include <string>
#include <vector>

namespace wobblebench::render {

/// OSMesa today; the interface keeps the rest of the renderer ignorant of which.
class GlContext {
 public:
  virtual ~GlContext() = default;
  GlContext() = default;
  GlContext(const GlContext&) = delete;
  GlContext& operator=(const GlContext&) = delete;

  virtual void make_current() = 0;
  virtual void* proc_address(const char* name) const = 0;
  virtual std::string backend() const = 0;
  /// GL_RENDERER and GL_VERSION, valid after make_current().
  std::string renderer_string() const;
};

/// Names that make_context takes in this build.
std::vector<std::string> context_backends();

/// Makes the context, makes it current and loads GL through it. GL's entry points are loaded once
/// for the process, so use contexts of one backend at a time. Throws std::runtime_error that says
/// which backends exist and what to install.
std::unique_ptr<GlContext> make_context(const std::string& backend = "osmesa");

}  // namespace wobblebench::render
