// Contexts of each backend: in sequence, at the same time, on several threads, lost and missing.
#include "render/gl/context.h"

#include <dlfcn.h>
#include <glad/gl.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <stdexcept>
#include <thread>

#include "render/gl/objects.h"
#include "render/renderer.h"
#include "tests/render/support/agreement.h"
#include "tests/render/support/synthetic.h"
#include "tests/support/expect.h"

/// Part of the file names of libraries that this process does not find.
static const char* hidden_libraries = nullptr;  // NOLINT: read by dlopen, before any object

/// In place of libc's, for this program and the libraries that it opens.
extern "C" void* dlopen(const char* file, int mode) noexcept {
  using Open = void* (*)(const char*, int);
  static const auto open = reinterpret_cast<Open>(dlsym(RTLD_NEXT, "dlopen"));
  const bool is_hidden = hidden_libraries && file && std::strstr(file, hidden_libraries);
  return is_hidden ? nullptr : open(file, mode);
}

namespace wobblebench::render {
namespace {

bool is_built(const std::string& backend) {
  const auto all = context_backends();
  return std::find(all.begin(), all.end(), backend) != all.end();
}

/// Error message of make_context for a backend; empty if it succeeds.
std::string refusal(const std::string& backend) {
  return refusal_of<std::runtime_error>([&] { static_cast<void>(make_context(backend)); });
}

bool is_llvmpipe(const GlContext& context) {
  return context.renderer_string().find("llvmpipe") != std::string::npos;
}

Picture picture_of(GlContext& context) {
  return render_volume(context, testing::noisy_scene(), testing::small_options());
}

TEST(GlContext, NamesItsBackendAndRenderer) {
  for (const std::string& backend : context_backends()) {
    if (!refusal(backend).empty()) continue;
    const auto context = make_context(backend);
    EXPECT_EQ(context->backend(), backend);
    EXPECT_TRUE(holds(context->renderer_string(), "OpenGL 4."));
  }
}

TEST(GlContext, ErrorOfAnUnknownBackendListsAllBackends) {
  std::string names = "auto";
  for (const std::string& backend : context_backends()) names += ", " + backend;
  EXPECT_EQ(refusal("glide"), "GL backend glide: this build has " + names);
}

TEST(GlContext, ErrorIsOneLineThatNamesTheBackend) {
  for (const std::string& backend : context_backends()) {
    const std::string reason = refusal(backend);
    if (reason.empty()) continue;
    EXPECT_EQ(reason.find(backend + ": "), 0u) << reason;
    EXPECT_FALSE(holds(reason, "\n"));
  }
}

/// Prints the error for a backend of which the environment variable hides a part. For a process of
/// its own, as libEGL searches for its drivers once.
void refuse_without(const char* variable, const std::string& backend) {
  setenv(variable, "/nonexistent", 1);
  const std::string reason = refusal(backend);
  std::fputs((reason.empty() ? backend + ": is made by another driver" : reason).c_str(), stderr);
  std::exit(0);
}

TEST(GlContextDeathTest, WithoutAnEglVendorNamesThePackage) {
  if (!is_built("egl")) GTEST_SKIP() << "built without EGL";
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  EXPECT_EXIT(refuse_without("__EGL_VENDOR_LIBRARY_DIRS", "egl"),
              ::testing::ExitedWithCode(0),
              "egl: .*: install (libegl-mesa0|libegl1)");
  EXPECT_EXIT(refuse_without("__EGL_VENDOR_LIBRARY_DIRS", "egl-device"),
              ::testing::ExitedWithCode(0),
              "egl-device: .*: install (libegl-mesa0|libegl1)");
}

TEST(GlContextDeathTest, WithoutADriverNamesThePackageAndEachDevice) {
  if (!is_built("egl")) GTEST_SKIP() << "built without EGL";
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  EXPECT_EXIT(refuse_without("LIBGL_DRIVERS_PATH", "egl"),
              ::testing::ExitedWithCode(0),
              "egl: (.*: install lib|is made by another)");
  EXPECT_EXIT(refuse_without("LIBGL_DRIVERS_PATH", "egl-device"),
              ::testing::ExitedWithCode(0),
              "egl-device: (no device gives an OpenGL 4.5 core context: (EGL lists none|device 0"
              ".*: its driver does not start: install libgl1-mesa-dri .EGL error 0x[0-9a-f]+.)|"
              ".*: install lib|is made by another)");
}

/// Prints what "auto" takes, or why it takes nothing, where these libraries are missing. For a
/// process of its own, as a library is searched for once.
void take_without(const char* libraries) {
  hidden_libraries = libraries;
  try {
    std::fputs(("takes " + make_context("auto")->backend()).c_str(), stderr);
  } catch (const std::runtime_error& error) {
    std::fputs(error.what(), stderr);
  }
  std::exit(0);
}

TEST(GlContext, AutoTakesTheFirstThatIsHere) {
  std::string first;
  for (const std::string& backend : context_backends()) {
    if (first.empty() && refusal(backend).empty()) first = backend;
  }
  EXPECT_EQ(make_context("auto")->backend(), first);
  EXPECT_EQ(make_context()->backend(), first);
}

TEST(GlContextDeathTest, AutoPassesOverWhatIsMissing) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  if (is_built("egl")) {
    EXPECT_EXIT(take_without("libOSMesa"),
                ::testing::ExitedWithCode(0),
                "takes egl|no OpenGL: .*egl: .*; egl-device: ");  // the machine may have neither
  }
  if (is_built("osmesa")) {
    EXPECT_EXIT(
        take_without("libEGL"), ::testing::ExitedWithCode(0), "takes osmesa|no OpenGL: osmesa: ");
  }
}

TEST(GlContextDeathTest, WithoutAnyLibraryAutoSaysWhatItTried) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  std::string reasons;
  for (const std::string& backend : context_backends()) {
    const bool is_osmesa = backend == "osmesa";
    reasons += (reasons.empty() ? "" : "; ") + backend + ": " +
               (is_osmesa ? "neither libOSMesa.so.8 nor libOSMesa.so is here: install libosmesa6"
                          : "libEGL.so.1 is not here: install libegl1");
  }
  EXPECT_EXIT(take_without("lib"), ::testing::ExitedWithCode(0), "^no OpenGL: " + reasons + "$");
}

class ContextOf : public ::testing::TestWithParam<std::string> {
 protected:
  void SetUp() override {
    const std::string missing = refusal(GetParam());
    if (!missing.empty()) GTEST_SKIP() << missing;
  }
};

TEST_P(ContextOf, MayBeDestroyedOnAnotherThread) {
  auto context = make_context(GetParam());
  const Picture expected = picture_of(*context);
  std::thread([&] { context.reset(); }).join();
  for (const std::string& next : context_backends()) {  // leaves the destroyed one
    if (!refusal(next).empty()) continue;
    EXPECT_EQ(make_context(next)->backend(), next);
  }
  testing::expect_same_bits(picture_of(*make_context(GetParam())), expected);
}

TEST_P(ContextOf, OutlivesTheRendererOnAnotherThread) {
  auto context = make_context(GetParam());
  auto renderer =
      std::make_unique<Renderer>(*context, testing::noisy_scene().plan(), testing::small_options());
  std::thread([&] { renderer.reset(); }).join();  // cannot delete what is current elsewhere
  EXPECT_GT(testing::hits(picture_of(*context).depth_m), 1000);
}

TEST_P(ContextOf, IsHandedToAnotherThreadAndBack) {
  const auto context = make_context(GetParam());
  const Picture expected = picture_of(*context);
  Picture theirs;
  std::string refused;
  std::thread([&] {
    refused = refusal_of<std::logic_error>([&] { context->make_current(); });
  }).join();
  EXPECT_EQ(refused, GetParam() + ": the context is current on another thread");
  context->release();
  std::thread([&] { theirs = picture_of(*context); }).join();  // whose end releases it
  testing::expect_same_bits(theirs, expected);
  testing::expect_same_bits(picture_of(*context), expected);
}

INSTANTIATE_TEST_SUITE_P(Backends,
                         ContextOf,
                         ::testing::ValuesIn(context_backends()),
                         [](const auto& test) {
                           return test.param == "egl-device" ? "egl_device" : test.param;
                         });

/// Replaces an entry point while it exists.
template <class Function>
class Replaced {
 public:
  Replaced(Function& entry, Function by) : entry_(entry), original_(entry) { entry = by; }
  ~Replaced() { entry_ = original_; }
  Replaced(const Replaced&) = delete;
  Replaced& operator=(const Replaced&) = delete;

 private:
  Function& entry_;
  Function original_;
};

/// What render() throws.
std::string loss(Renderer& renderer) {
  try {
    renderer.render();
  } catch (const ContextLost& error) {
    return error.what();
  }
  return "no ContextLost";
}

TEST(GlContext, LossHasAName) {
  const auto context = make_context();
  Renderer renderer(*context, testing::noisy_scene().plan(), testing::small_options());
  {
    const Replaced reset(
        glad_glGetGraphicsResetStatus, +[]() -> GLenum { return GL_GUILTY_CONTEXT_RESET; });
    EXPECT_EQ(loss(renderer),
              "before rendering: the OpenGL context is lost: the GPU was reset because of it");
  }
  {
    const Replaced errors(
        glad_glGetError, +[]() -> GLenum { return GL_CONTEXT_LOST; });
    EXPECT_EQ(loss(renderer),
              "before rendering: the OpenGL context is lost: the driver gives no reason");
  }
  EXPECT_EQ(renderer.render().depth_m.width, testing::small_options().ray_casting.image_size);
}

/// A backend beside osmesa.
class OtherBackend : public ::testing::TestWithParam<std::string> {
 protected:
  void SetUp() override {
    for (const std::string& backend : {std::string("osmesa"), GetParam()}) {
      const std::string missing = refusal(backend);
      if (!missing.empty()) GTEST_SKIP() << missing;
    }
    osmesa_ = make_context("osmesa");
    other_ = make_context(GetParam());
  }

  std::unique_ptr<GlContext> osmesa_;
  std::unique_ptr<GlContext> other_;
};

TEST_P(OtherBackend, RendersTheSamePictureBitForBit) {
  const Picture theirs = picture_of(*other_);
  const std::string renderer = other_->renderer_string();
  const Picture ours = picture_of(*osmesa_);
  if (osmesa_->renderer_string() != renderer || !is_llvmpipe(*osmesa_)) {
    GTEST_SKIP() << "osmesa is " << osmesa_->renderer_string() << ", " << GetParam() << " is "
                 << renderer;
  }
  EXPECT_GT(testing::hits(ours.depth_m), 1000);
  testing::expect_same_bits(ours, theirs);
}

TEST_P(OtherBackend, AlternatesWithOsmesa) {
  const hw::PolarVolume& volume = testing::noisy_scene();
  const Picture expected = picture_of(*other_);
  Renderer here(*osmesa_, volume.plan(), testing::small_options());
  Renderer there(*other_, volume.plan(), testing::small_options());
  for (int frame = 0; frame < volume.plan().acquisition().frames_per_volume; ++frame) {
    here.add_frame(frame, volume.frame(frame));
    there.add_frame(frame, volume.frame(frame));
  }
  const Picture ours = here.render();
  testing::expect_same_bits(there.render(), expected);
  testing::expect_same_bits(ours, picture_of(*osmesa_));
}

TEST_P(OtherBackend, WorksAfterTheCurrentContextIsDestroyed) {
  const Picture expected = picture_of(*other_);
  osmesa_->make_current();
  osmesa_.reset();
  testing::expect_same_bits(picture_of(*other_), expected);
}

INSTANTIATE_TEST_SUITE_P(GlContext,
                         OtherBackend,
                         ::testing::Values("egl", "egl-device"),
                         [](const auto& test) {
                           return test.param == "egl" ? "Surfaceless" : "Device";
                         });

}  // namespace
}  // namespace wobblebench::render
