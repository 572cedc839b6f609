// Contexts of each backend, in sequence and at the same time.
#include "render/gl/context.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <stdexcept>

#include "render/renderer.h"
#include "tests/render/support/synthetic.h"

namespace wobblebench::render {
namespace {

/// Error message of make_context for a backend; empty if it succeeds.
std::string refusal(const std::string& backend) {
  try {
    static_cast<void>(make_context(backend));
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return {};
}

/// Bitwise, so that NaN (no surface) equals itself.
template <class Pixel>
bool same_bits(const Image<Pixel>& a, const Image<Pixel>& b) {
  return a.pixels.size() == b.pixels.size() && !a.pixels.empty() &&
         std::memcmp(a.pixels.data(), b.pixels.data(), a.pixels.size() * sizeof(Pixel)) == 0;
}

void expect_same(const Picture& a, const Picture& b) {
  EXPECT_TRUE(same_bits(a.surface, b.surface));
  EXPECT_TRUE(same_bits(a.volume, b.volume));
  EXPECT_TRUE(same_bits(a.depth_m, b.depth_m));
  EXPECT_TRUE(same_bits(a.filtered_depth_m, b.filtered_depth_m));
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
    EXPECT_NE(context->renderer_string().find("OpenGL 4."), std::string::npos)
        << context->renderer_string();
  }
}

TEST(GlContext, ErrorOfAnUnknownBackendListsAllBackends) {
  EXPECT_EQ(refusal("glide"), "GL backend glide: this build has osmesa, egl, egl-device");
}

TEST(GlContext, ErrorIsOneLineThatNamesTheBackend) {
  for (const std::string& backend : context_backends()) {
    const std::string reason = refusal(backend);
    if (reason.empty()) continue;
    EXPECT_EQ(reason.find(backend + ": "), 0u) << reason;
    EXPECT_EQ(reason.find('\n'), std::string::npos) << reason;
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
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  EXPECT_EXIT(refuse_without("__EGL_VENDOR_LIBRARY_DIRS", "egl"),
              ::testing::ExitedWithCode(0),
              "egl: .*: install (libegl-mesa0|libegl1)");
  EXPECT_EXIT(refuse_without("__EGL_VENDOR_LIBRARY_DIRS", "egl-device"),
              ::testing::ExitedWithCode(0),
              "egl-device: .*: install (libegl-mesa0|libegl1)");
}

TEST(GlContextDeathTest, WithoutADriverNamesThePackageOrTheNumberOfDevices) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  EXPECT_EXIT(refuse_without("LIBGL_DRIVERS_PATH", "egl"),
              ::testing::ExitedWithCode(0),
              "egl: (.*: install lib|is made by another)");
  EXPECT_EXIT(refuse_without("LIBGL_DRIVERS_PATH", "egl-device"),
              ::testing::ExitedWithCode(0),
              "egl-device: (no device gives an OpenGL 4.5 core context .[0-9]+ devices? asked|.*: "
              "install lib|is made by another)");
}

/// A backend beside osmesa.
class OtherBackend : public ::testing::TestWithParam<std::string> {
 protected:
  void SetUp() override {
    const std::string missing = refusal(GetParam());
    if (!missing.empty()) GTEST_SKIP() << missing;
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
  expect_same(ours, theirs);
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
  expect_same(there.render(), expected);
  expect_same(ours, picture_of(*osmesa_));
}

TEST_P(OtherBackend, WorksAfterTheCurrentContextIsDestroyed) {
  const Picture expected = picture_of(*other_);
  osmesa_->make_current();
  osmesa_.reset();
  expect_same(picture_of(*other_), expected);
}

INSTANTIATE_TEST_SUITE_P(GlContext,
                         OtherBackend,
                         ::testing::Values("egl", "egl-device"),
                         [](const auto& test) {
                           return test.param == "egl" ? "Surfaceless" : "Device";
                         });

}  // namespace
}  // namespace wobblebench::render
