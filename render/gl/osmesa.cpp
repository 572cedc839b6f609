#include "render/gl/backends.h"

#include <GL/osmesa.h>
#include <dlfcn.h>

#include <array>
#include <stdexcept>

namespace wobblebench::render {
namespace {

/// libOSMesa, loaded at the first call and kept for the life of the process.
void* library() {
  static void* const loaded = [] {
    void* first = dlopen("libOSMesa.so.8", RTLD_NOW | RTLD_LOCAL);
    return first ? first : dlopen("libOSMesa.so", RTLD_NOW | RTLD_LOCAL);
  }();
  if (!loaded) {
    throw std::runtime_error(
        "osmesa: neither libOSMesa.so.8 nor libOSMesa.so is here: install libosmesa6");
  }
  return loaded;
}

template <class Function>
Function entry(const char* name) {
  void* found = dlsym(library(), name);
  if (!found) throw std::runtime_error(std::string("osmesa: libOSMesa has no ") + name);
  return reinterpret_cast<Function>(found);
}

struct DestroyContext {
  decltype(&OSMesaDestroyContext) destroy = nullptr;
  void operator()(osmesa_context* context) const { destroy(context); }
};

class OsmesaContext final : public DriverContext {
 public:
  OsmesaContext() {
    const auto create = entry<decltype(&OSMesaCreateContextAttribs)>("OSMesaCreateContextAttribs");
    make_current_ = entry<decltype(&OSMesaMakeCurrent)>("OSMesaMakeCurrent");
    proc_address_ = entry<decltype(&OSMesaGetProcAddress)>("OSMesaGetProcAddress");
    const std::array<int, 9> attributes = {OSMESA_FORMAT,
                                           OSMESA_RGBA,
                                           OSMESA_PROFILE,
                                           OSMESA_CORE_PROFILE,
                                           OSMESA_CONTEXT_MAJOR_VERSION,
                                           4,
                                           OSMESA_CONTEXT_MINOR_VERSION,
                                           5,
                                           0};
    const DestroyContext destroy{entry<decltype(&OSMesaDestroyContext)>("OSMesaDestroyContext")};
    context_ = {create(attributes.data(), nullptr), destroy};
    if (!context_) throw std::runtime_error("osmesa: gives no OpenGL 4.5 core context");
  }

  void* proc_address(const char* name) const override {
    return reinterpret_cast<void*>(proc_address_(name));
  }
  std::string backend() const override { return "osmesa"; }
  void bind() override {
    if (!make_current_(context_.get(), pixels_.data(), GL_UNSIGNED_BYTE, kSide, kSide)) {
      throw std::runtime_error("osmesa: the context cannot be made current");
    }
  }
  void unbind() override { make_current_(nullptr, nullptr, 0, 0, 0); }

 private:
  // OSMesa requires a default framebuffer; all drawing goes to framebuffer objects.
  static constexpr int kSide = 8;
  std::array<unsigned char, std::size_t{4} * kSide * kSide> pixels_{};
  std::unique_ptr<osmesa_context, DestroyContext> context_;
  decltype(&OSMesaMakeCurrent) make_current_ = nullptr;
  decltype(&OSMesaGetProcAddress) proc_address_ = nullptr;
};

}  // namespace

std::unique_ptr<GlContext> make_osmesa_context() {
  return std::make_unique<GlContext>(std::make_shared<OsmesaContext>());
}

}  // namespace wobblebench::render
