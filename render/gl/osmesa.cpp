#include "render/gl/backends.h"

#include <GL/osmesa.h>
#include <dlfcn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <stdexcept>
#include <string>

#include "base/shared_library.h"

namespace wobblebench::render {
namespace {

/// libOSMesa, loaded at the first call and kept for the life of the process.
void* libosmesa() {
  static void* const loaded = [] {
    void* first = load_library("libOSMesa.so.8");
    return first ? first : load_library("libOSMesa.so");
  }();
  if (!loaded) {
    throw std::runtime_error(
        "osmesa: neither libOSMesa.so.8 nor libOSMesa.so is here: install libosmesa6");
  }
  return loaded;
}

template <class Function>
Function osmesa_entry(const char* name) {
  void* found = dlsym(libosmesa(), name);
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
    const auto create =
        osmesa_entry<decltype(&OSMesaCreateContextAttribs)>("OSMesaCreateContextAttribs");
    make_current_ = osmesa_entry<decltype(&OSMesaMakeCurrent)>("OSMesaMakeCurrent");
    proc_address_ = osmesa_entry<decltype(&OSMesaGetProcAddress)>("OSMesaGetProcAddress");
    const std::array<int, 9> attributes = {OSMESA_FORMAT,
                                           OSMESA_RGBA,
                                           OSMESA_PROFILE,
                                           OSMESA_CORE_PROFILE,
                                           OSMESA_CONTEXT_MAJOR_VERSION,
                                           4,
                                           OSMESA_CONTEXT_MINOR_VERSION,
                                           5,
                                           0};
    const DestroyContext destroy{
        osmesa_entry<decltype(&OSMesaDestroyContext)>("OSMesaDestroyContext")};
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

/// Makes a context in a process of its own: Mesa crashes for the name of a driver that it lacks.
void try_driver(const std::string& name) {
  libosmesa();
  const pid_t child = ::fork();
  if (child < 0) return;
  if (child == 0) {
    std::signal(SIGSEGV, SIG_DFL);  // whatever this program does with a crash of its own
    try {
      OsmesaContext().bind();
    } catch (const std::exception&) {
      ::_exit(1);
    }
    ::_exit(0);
  }
  int status = 0;
  while (::waitpid(child, &status, 0) < 0) {
    if (errno != EINTR) return;
  }
  if (!WIFSIGNALED(status)) return;
  throw std::runtime_error("osmesa: crashes (" + std::string(::strsignal(WTERMSIG(status))) +
                           ") where GALLIUM_DRIVER = " + name +
                           "; unset it, or set it to llvmpipe");
}

}  // namespace

std::unique_ptr<GlContext> make_osmesa_context() {
  if (const char* driver = std::getenv("GALLIUM_DRIVER")) try_driver(driver);
  return std::make_unique<GlContext>(std::make_shared<OsmesaContext>());
}

}  // namespace wobblebench::render
