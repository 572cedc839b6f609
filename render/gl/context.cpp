#include "render/gl/context.h"

#include <glad/gl.h>

#include <stdexcept>

#include "render/gl/egl.h"
#include "render/gl/osmesa.h"

namespace wobblebench::render {
namespace {

// State that OpenGL and its loader keep outside any object, mirrored here.

/// GL's current context of this thread.
thread_local GlContext* current_context = nullptr;

/// Backend whose entry points glad's table, one per process, holds; empty: none.
std::string loaded_backend;

GLADapiproc load_entry(void* context, const char* name) {
  return reinterpret_cast<GLADapiproc>(static_cast<const GlContext*>(context)->proc_address(name));
}

/// Fills glad's table unless it already holds this backend's entry points.
void load_functions(GlContext& context) {
  const std::string backend = context.backend();
  if (loaded_backend == backend) return;
  loaded_backend.clear();
  if (gladLoadGLUserPtr(load_entry, &context) < GLAD_MAKE_VERSION(4, 5)) {
    throw std::runtime_error(backend + ": OpenGL 4.5 cannot be loaded");
  }
  loaded_backend = backend;
}

std::string gl_string(GLenum name) {
  const auto* text = reinterpret_cast<const char*>(glGetString(name));
  return text ? text : "unknown";
}

std::unique_ptr<GlContext> make_unloaded(const std::string& backend) {
  if (backend == "osmesa") return make_osmesa_context();
  if (backend == "egl") return make_surfaceless_context();
  if (backend == "egl-device") return make_device_context();
  std::string names;
  for (const auto& name : context_backends()) names += (names.empty() ? "" : ", ") + name;
  throw std::runtime_error("GL backend " + backend + ": this build has " + names);
}

}  // namespace

void GlContext::make_current() {
  // A backend caches its current context, so it is unbound before another backend replaces it.
  if (current_context && current_context->backend() != backend()) current_context->release();
  bind();
  current_context = this;
  load_functions(*this);
}

void GlContext::release() {
  if (current_context != this) return;
  current_context = nullptr;
  unbind();
}

std::string GlContext::renderer_string() const {
  return gl_string(GL_RENDERER) + ", OpenGL " + gl_string(GL_VERSION);
}

std::vector<std::string> context_backends() {
  return {"osmesa", "egl", "egl-device"};
}

std::unique_ptr<GlContext> make_context(const std::string& backend) {
  auto context = make_unloaded(backend);
  context->make_current();
  return context;
}

}  // namespace wobblebench::render
