#include "render/gl/backends.h"

// Without it the header includes X11.
#define EGL_NO_X11
#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <dlfcn.h>

#include <algorithm>
#include <array>
#include <sstream>
#include <stdexcept>
#include <vector>

#include "base/shared_library.h"

namespace wobblebench::render {
namespace {

/// libEGL, loaded at the first call and kept for the life of the process.
void* libegl() {
  static void* const loaded = load_library("libEGL.so.1");
  if (!loaded) throw std::runtime_error("libEGL.so.1 is not here: install libegl1");
  return loaded;
}

template <class Function>
Function egl_entry(const char* name) {
  void* found = dlsym(libegl(), name);
  if (!found) throw std::runtime_error(std::string("libEGL has no ") + name);
  return reinterpret_cast<Function>(found);
}

/// Functions that libEGL exports.
struct Egl {
  decltype(&eglBindAPI) bind_api = egl_entry<decltype(&eglBindAPI)>("eglBindAPI");
  decltype(&eglCreateContext) create = egl_entry<decltype(&eglCreateContext)>("eglCreateContext");
  decltype(&eglDestroyContext) destroy =
      egl_entry<decltype(&eglDestroyContext)>("eglDestroyContext");
  decltype(&eglGetError) error = egl_entry<decltype(&eglGetError)>("eglGetError");
  decltype(&eglGetPlatformDisplay) platform_display =
      egl_entry<decltype(&eglGetPlatformDisplay)>("eglGetPlatformDisplay");
  decltype(&eglGetProcAddress) proc_address =
      egl_entry<decltype(&eglGetProcAddress)>("eglGetProcAddress");
  decltype(&eglInitialize) initialize = egl_entry<decltype(&eglInitialize)>("eglInitialize");
  decltype(&eglMakeCurrent) make_current = egl_entry<decltype(&eglMakeCurrent)>("eglMakeCurrent");
  decltype(&eglQueryString) query_string = egl_entry<decltype(&eglQueryString)>("eglQueryString");

  /// Throws `what` with the code of the call that failed; ContextLost if that is the reason.
  [[noreturn]] void fail(const std::string& what) const {
    const EGLint code = error();
    std::ostringstream text;
    text << what << " (EGL error 0x" << std::hex << code << ")";
    if (code == EGL_CONTEXT_LOST) throw ContextLost(text.str());
    throw std::runtime_error(text.str());
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
  if (display == EGL_NO_DISPLAY) egl.fail("has no driver: install libegl-mesa0");
  if (!egl.initialize(display, nullptr, nullptr)) {
    egl.fail("its driver does not start: install libgl1-mesa-dri");
  }
  const char* extensions = egl.query_string(display, EGL_EXTENSIONS);
  for (const char* needed : {"EGL_KHR_no_config_context", "EGL_KHR_surfaceless_context"}) {
    if (!contains(extensions, needed)) throw std::runtime_error(std::string("lacks ") + needed);
  }
  return display;
}

/// EGL's description of an OpenGL 4.5 core context, with what `more` adds.
std::vector<EGLint> attributes(std::initializer_list<EGLint> more) {
  std::vector<EGLint> list = {EGL_CONTEXT_MAJOR_VERSION,
                              4,
                              EGL_CONTEXT_MINOR_VERSION,
                              5,
                              EGL_CONTEXT_OPENGL_PROFILE_MASK,
                              EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT};
  list.insert(list.end(), more);
  list.push_back(EGL_NONE);
  return list;
}

class EglContext final : public DriverContext {
 public:
  EglContext(const Egl& egl, EGLDisplay display, std::string backend)
      : egl_(egl), display_(display), backend_(std::move(backend)) {
    egl_.bind_api(EGL_OPENGL_API);
    // One that says when it is lost, if the driver has such.
    context_ = create({EGL_CONTEXT_OPENGL_RESET_NOTIFICATION_STRATEGY, EGL_LOSE_CONTEXT_ON_RESET});
    if (context_ == EGL_NO_CONTEXT) context_ = create({});
    if (context_ == EGL_NO_CONTEXT) egl_.fail("gives no OpenGL 4.5 core context");
  }
  ~EglContext() override { egl_.destroy(display_, context_); }

  void* proc_address(const char* name) const override {
    return reinterpret_cast<void*>(egl_.proc_address(name));
  }
  std::string backend() const override { return backend_; }
  void bind() override {
    // The bound API is per-thread state, which unbind() relies on.
    egl_.bind_api(EGL_OPENGL_API);
    if (egl_.make_current(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_)) return;
    egl_.fail(backend_ + ": the context cannot be made current");
  }
  void unbind() override {
    egl_.make_current(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
  }

 private:
  EGLContext create(std::initializer_list<EGLint> more) const {
    return egl_.create(display_, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, attributes(more).data());
  }

  const Egl egl_;
  EGLDisplay display_;
  std::string backend_;
  EGLContext context_ = EGL_NO_CONTEXT;
};

/// A client extension is one that needs no display.
bool has(const Egl& egl, const char* extension) {
  return contains(egl.query_string(EGL_NO_DISPLAY, EGL_EXTENSIONS), extension);
}

void require(const Egl& egl, const char* extension) {
  if (has(egl, extension)) return;
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

/// Name of a device in errors: its number, and its device file if it has one.
std::string device_name(const Egl& egl, EGLDeviceEXT device, std::size_t number) {
  const auto text = egl.extension<PFNEGLQUERYDEVICESTRINGEXTPROC>("eglQueryDeviceStringEXT");
  const char* extensions = text(device, EGL_EXTENSIONS);
  const char* file =
      contains(extensions, "EGL_EXT_device_drm") ? text(device, EGL_DRM_DEVICE_FILE_EXT) : nullptr;
  const bool is_software = contains(extensions, "EGL_MESA_device_software");
  return "device " + std::to_string(number) +
         (file          ? std::string(" (") + file + ")"
          : is_software ? " (software)"
                        : "");
}

/// A context of this device, made current, as drivers may fail only then.
std::unique_ptr<GlContext> make_on_device(const Egl& egl, EGLDeviceEXT device) {
  auto context = std::make_unique<GlContext>(std::make_shared<EglContext>(
      egl, open_display(egl, EGL_PLATFORM_DEVICE_EXT, device), "egl-device"));
  context->make_current();
  return context;
}

}  // namespace

std::unique_ptr<GlContext> make_surfaceless_context() {
  return with_backend_name("egl", [] {
    const Egl egl;
    require(egl, "EGL_MESA_platform_surfaceless");
    return std::make_unique<GlContext>(std::make_shared<EglContext>(
        egl, open_display(egl, EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY), "egl"));
  });
}

std::unique_ptr<GlContext> make_device_context() {
  return with_backend_name("egl-device", [] {
    const Egl egl;
    // NVIDIA's driver names the older extension alone, which two others have replaced.
    if (!has(egl, "EGL_EXT_device_base")) require(egl, "EGL_EXT_device_enumeration");
    require(egl, "EGL_EXT_platform_device");
    std::string reasons;
    std::size_t number = 0;
    for (const EGLDeviceEXT device : devices(egl)) {
      try {
        return make_on_device(egl, device);
      } catch (const std::runtime_error& reason) {
        reasons += (number ? "; " : ": ") + device_name(egl, device, number) + ": " + reason.what();
      }
      ++number;
    }
    throw std::runtime_error("no device gives an OpenGL 4.5 core context" +
                             (number ? reasons : ": EGL lists none"));
  });
}

}  // namespace wobblebench::render
