#include "render/gl_context.h"

#include <glad/gl.h>

#include <stdexcept>

#include "render/gl_osmesa.h"

namespace wobblebench::render {
namespace {

GLADapiproc load_entry(void* context, const char* name) {
  return reinterpret_cast<GLADapiproc>(static_cast<const GlContext*>(context)->proc_address(name));
}

std::string gl_string(GLenum name) {
  const auto* text = reinterpret_cast<const char*>(glGetString(name));
  return text ? text : "unknown";
}

}  // namespace

std::string GlContext::renderer_string() const {
  return gl_string(GL_RENDERER) + ", OpenGL " + gl_string(GL_VERSION);
}

std::vector<std::string> context_backends() {
  return {"osmesa"};
}

std::unique_ptr<GlContext> make_context(const std::string& backend) {
  if (backend != "osmesa") {
    throw std::runtime_error("GL backend " + backend + ": this build has osmesa");
  }
  std::unique_ptr<GlContext> context = make_osmesa_context();
  context->make_current();
  const int version = gladLoadGLUserPtr(load_entry, context.get());
  if (version < GLAD_MAKE_VERSION(4, 5)) {
    throw std::runtime_error("GL backend " + backend + ": OpenGL 4.5 cannot be loaded");
  }
  return context;
}

}  // namespace wobblebench::render
