#include "render/gl/egl.h"

// Without it the header includes X11.
#define EGL_NO_X11
#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <dlfcn.h>

#include <algorithm>
#include <array>
#include <sstream>
#include <stdexcept>

namespace wobblebench::render {
namespace {

/// libEGL, loaded at the first call and kept for the life of the process.
void* library() {
  static void* const loaded = dlopen("libEGL.so.1", RTLD_NOW | RTLD_LOCAL);
  if (!loaded) throw std::runtime_error("libEGL.so.1 is not here: install libegl1");
  return loaded;
}

template <class Function>
Function entry(const char* name) {
  void* found = dlsym(library(), name);
  if (!found) throw std::runtime_error(std::string("libEGL has no ") + name);
  return reinterpret_cast<Function>(found);
}

/// Functions that libEGL exports.
struct Egl {
  decltype(&eglBindAPI) bind_api = entry<decltype(&eglBindAPI)>("eglBindAPI");
  decltype(&eglCreateContext) create = entry<decltype(&eglCreateContext)>("eglCreateContext");
  decltype(&eglDestroyContext) destroy = entry<decltype(&eglDestroyContext)>("eglDestroyContext");
  decltype(&eglGetError) error = entry<decltype(&eglGetError)>("eglGetError");
  decltype(&eglGetPlatformDisplay) platform_display =
      entry<decltype(&eglGetPlatformDisplay)>("eglGetPlatformDisplay");
  decltype(&eglGetProcAddress) proc_address =
      entry<decltype(&eglGetProcAddress)>("eglGetProcAddress");
  decltype(&eglInitialize) initialize = entry<decltype(&eglInitialize)>("eglInitialize");
  decltype(&eglMakeCurrent) make_current = entry<decltype(&eglMakeCurrent)>("eglMakeCurrent");
  decltype(&eglQueryString) query_string = entry<decltype(&eglQueryString)>("eglQueryString");

  /// `what`, and the code of the call that failed.
  std::runtime_error failure(const std::string& what) const {
    std::ostringstream text;
    text << what << " (EGL error 0x" << std::hex << error() << ")";
    return std::runtime_error(text.str());
  }

  template <class Function>
  Function extension(const char* name) const {
    const auto found = proc_address(name);
    if (!found) throw std::runtime_error(std::string("libEGL has no ") + name);
    return reinterpret_cast<Function>(found);
  }
};

bool contains(const char* extensions, const std::string& name) {
  std::istringstream words(extensions ? extensions : "");
  for (std::string word; words >> word;) {
    if (word == name) return true;
  }
  return false;
}

/// A display is shared by the whole process, so it is never terminated.
EGLDisplay open_display(const Egl& egl, EGLenum platform, void* native) {
  const EGLDisplay display = egl.platform_display(platform, native, nullptr);
  if (display == EGL_NO_DISPLAY) throw egl.failure("has no driver: install libegl-mesa0");
  if (!egl.initialize(display, nullptr, nullptr)) {
    throw egl.failure("its driver does not start: install libgl1-mesa-dri");
  }
  const char* extensions = egl.query_string(display, EGL_EXTENSIONS);
  for (const char* needed : {"EGL_KHR_no_config_context", "EGL_KHR_surfaceless_context"}) {
    if (!contains(extensions, needed)) throw std::runtime_error(std::string("lacks ") + needed);
  }
  return display;
}

class EglContext final : public GlContext {
 public:
  EglContext(const Egl& egl, EGLDisplay display, std::string backend)
      : egl_(egl), display_(display), backend_(std::move(backend)) {
    constexpr std::array<EGLint, 7> kAttributes = {EGL_CONTEXT_MAJOR_VERSION,
                                                   4,
                                                   EGL_CONTEXT_MINOR_VERSION,
                                                   5,
                                                   EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                                   EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                                   EGL_NONE};
    egl_.bind_api(EGL_OPENGL_API);
    context_ = egl_.create(display_, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, kAttributes.data());
    if (context_ == EGL_NO_CONTEXT) throw egl_.failure("gives no OpenGL 4.5 core context");
  }
  ~EglContext() override {
    release();
    egl_.destroy(display_, context_);
  }

  void* proc_address(const char* name) const override {
    return reinterpret_cast<void*>(egl_.proc_address(name));
  }
  std::string backend() const override { return backend_; }

 private:
  void bind() override {
    // The bound API is per-thread state, which unbind() relies on.
    egl_.bind_api(EGL_OPENGL_API);
    if (egl_.make_current(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_)) return;
    throw egl_.failure(backend_ + ": the context cannot be made current");
  }
  void unbind() override {
    egl_.make_current(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
  }

  const Egl egl_;
  EGLDisplay display_;
  std::string backend_;
  EGLContext context_ = EGL_NO_CONTEXT;
};

/// Checks for a client extension, one that needs no display.
void require(const Egl& egl, const char* extension) {
  if (contains(egl.query_string(EGL_NO_DISPLAY, EGL_EXTENSIONS), extension)) return;
  throw std::runtime_error(std::string("libEGL lacks ") + extension + ": install libegl-mesa0");
}

/// All EGL devices, hardware first, else in EGL's order.
std::vector<EGLDeviceEXT> devices(const Egl& egl) {
  const auto query = egl.extension<PFNEGLQUERYDEVICESEXTPROC>("eglQueryDevicesEXT");
  const auto text = egl.extension<PFNEGLQUERYDEVICESTRINGEXTPROC>("eglQueryDeviceStringEXT");
  std::vector<EGLDeviceEXT> found(64);
  EGLint count = 0;
  if (!query(static_cast<EGLint>(found.size()), found.data(), &count)) count = 0;
  found.resize(static_cast<std::size_t>(count));
  std::stable_partition(found.begin(), found.end(), [&](EGLDeviceEXT device) {
    return !contains(text(device, EGL_EXTENSIONS), "EGL_MESA_device_software");
  });
  return found;
}

/// Result of make(); an error is prefixed with the backend's name.
template <class Make>
std::unique_ptr<GlContext> with_backend_name(const std::string& backend, const Make& make) {
  try {
    return make();
  } catch (const std::runtime_error& reason) {
    throw std::runtime_error(backend + ": " + reason.what());
  }
}

/// A context of this device, made current, as drivers may fail only then; null if it gives none.
std::unique_ptr<GlContext> try_device(const Egl& egl, EGLDeviceEXT device) {
  try {
    auto context = std::make_unique<EglContext>(
        egl, open_display(egl, EGL_PLATFORM_DEVICE_EXT, device), "egl-device");
    context->make_current();
    return context;
  } catch (const std::runtime_error&) {
    return nullptr;
  }
}

}  // namespace

std::unique_ptr<GlContext> make_surfaceless_context() {
  return with_backend_name("egl", [] {
    const Egl egl;
    require(egl, "EGL_MESA_platform_surfaceless");
    return std::make_unique<EglContext>(
        egl, open_display(egl, EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY), "egl");
  });
}

std::unique_ptr<GlContext> make_device_context() {
  return with_backend_name("egl-device", [] {
    const Egl egl;
    require(egl, "EGL_EXT_device_enumeration");
    require(egl, "EGL_EXT_platform_device");
    const auto candidates = devices(egl);
    for (const EGLDeviceEXT device : candidates) {
      if (auto context = try_device(egl, device)) return context;
    }
    throw std::runtime_error("no device gives an OpenGL 4.5 core context (" +
                             std::to_string(candidates.size()) +
                             (candidates.size() == 1 ? " device" : " devices") + " asked)");
  });
}

}  // namespace wobblebench::render
