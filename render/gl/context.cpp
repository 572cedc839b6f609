#include "render/gl/context.h"

#include <glad/gl.h>

#include <utility>

#include "render/gl/backends.h"

namespace wobblebench::render {
namespace {

// State that OpenGL and its loader keep outside any object, mirrored here.

/// Whether this thread's `current` is gone: static objects are destroyed after it.
thread_local bool has_ended = false;

/// GL's current context of a thread.
struct CurrentContext {
  std::shared_ptr<DriverContext> driver;

  void leave() {
    if (!driver) return;
    driver->unbind();
    driver->is_current = false;
    driver.reset();
  }
  ~CurrentContext() {
    leave();
    has_ended = true;
  }
};
thread_local CurrentContext current;

/// Backend whose entry points glad's table, one per process, holds; empty: none.
std::string loaded_backend;

GLADapiproc load_entry(void* driver, const char* name) {
  return reinterpret_cast<GLADapiproc>(
      static_cast<const DriverContext*>(driver)->proc_address(name));
}

/// Fills glad's table unless it already holds this backend's entry points.
void load_functions(DriverContext& driver) {
  const std::string backend = driver.backend();
  if (loaded_backend == backend) return;
  loaded_backend.clear();
  if (gladLoadGLUserPtr(load_entry, &driver) < GLAD_MAKE_VERSION(4, 5)) {
    throw std::runtime_error(backend + ": OpenGL 4.5 cannot be loaded");
  }
  loaded_backend = backend;
}

std::string gl_string(GLenum name) {
  const auto* text = reinterpret_cast<const char*>(glGetString(name));
  return text ? text : "unknown";
}

struct Backend {
  std::string name;
  std::unique_ptr<GlContext> (*make)();
};

/// Of this build, in the order in which `auto` tries them.
const std::vector<Backend>& backends() {
  static const std::vector<Backend> all = {
#ifdef WOBBLEBENCH_HAS_OSMESA
      {"osmesa", make_osmesa_context},
#endif
#ifdef WOBBLEBENCH_HAS_EGL
      {"egl", make_surfaceless_context},
      {"egl-device", make_device_context},
#endif
  };
  return all;
}

std::unique_ptr<GlContext> make_current_context(const Backend& backend) {
  auto context = backend.make();
  context->make_current();
  return context;
}

std::unique_ptr<GlContext> make_first_context() {
  std::string reasons;
  for (const Backend& backend : backends()) {
    try {
      return make_current_context(backend);
    } catch (const std::runtime_error& reason) {
      reasons += (reasons.empty() ? "" : "; ") + std::string(reason.what());
    }
  }
  throw std::runtime_error("no OpenGL: " + reasons);
}

}  // namespace

std::shared_ptr<ProgramPool> current_program_pool() {
  return !has_ended && current.driver ? current.driver->programs : nullptr;
}

GlContext::GlContext(std::shared_ptr<DriverContext> driver) : driver_(std::move(driver)) {}

GlContext::~GlContext() {
  release();
}

void GlContext::make_current() {
  if (has_ended) throw std::logic_error(backend() + ": the thread has ended");
  const bool was_current = current.driver == driver_;
  if (!was_current && driver_->is_current) {
    throw std::logic_error(backend() + ": the context is current on another thread");
  }
  // A backend caches its current context, so it is unbound before another backend replaces it.
  if (current.driver && current.driver->backend() != backend()) current.leave();
  driver_->bind();
  if (!was_current) {
    if (current.driver) current.driver->is_current = false;
    current.driver = driver_;
    driver_->is_current = true;
  }
  load_functions(*driver_);
}

void GlContext::release() {
  if (!has_ended && current.driver == driver_) current.leave();
}

void* GlContext::proc_address(const char* name) const {
  return driver_->proc_address(name);
}

std::string GlContext::backend() const {
  return driver_->backend();
}

std::string GlContext::renderer_string() const {
  return gl_string(GL_RENDERER) + ", OpenGL " + gl_string(GL_VERSION);
}

std::vector<std::string> context_backends() {
  std::vector<std::string> names;
  for (const Backend& backend : backends()) names.push_back(backend.name);
  return names;
}

std::unique_ptr<GlContext> make_context(const std::string& backend) {
  if (backend == "auto") return make_first_context();
  std::string names = "auto";
  for (const Backend& one : backends()) {
    if (one.name == backend) return make_current_context(one);
    names += ", " + one.name;
  }
  throw std::runtime_error("GL backend " + backend + ": this build has " + names);
}

}  // namespace wobblebench::render
