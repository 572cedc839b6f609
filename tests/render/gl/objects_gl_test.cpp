#include "render/gl/objects.h"

#include <gtest/gtest.h>

#include <stdexcept>

#include "render/gl/program.h"
#include "render/gl/timer.h"
#include "tests/render/support/gl_fixture.h"
#include "tests/support/expect.h"

namespace wobblebench::render {
namespace {

using testing::gl_context;

/// Message of the runtime_error that a callable throws; empty if none.
template <class Function>
std::string error_of(Function function) {
  return refusal_of<std::runtime_error>([&] { function(); });
}

TEST(Texture, IsEmptyUntilMadeAndAfterMoving) {
  gl_context();
  Texture empty;
  EXPECT_FALSE(empty);
  Texture made("test", TexelFormat::r32f, {4, 2}, TextureFilter::nearest);
  ASSERT_TRUE(made);
  const unsigned id = made.id();
  const Texture moved = std::move(made);
  EXPECT_EQ(moved.id(), id);
  EXPECT_FALSE(made);  // NOLINT(bugprone-use-after-move): the empty state is part of the contract
}

TEST(Texture, StartsAtZeroAndReturnsWhatWasUploaded) {
  gl_context();
  for (TexelFormat format : {TexelFormat::r16, TexelFormat::r32f}) {
    Texture texture("test", format, {3, 2}, TextureFilter::nearest);
    EXPECT_EQ(texture.download(), std::vector<float>(6, 0.0f));
    const std::vector<float> values = {0, 0.25f, 0.5f, 1, 0.125f, 0.75f};
    texture.upload(values);
    const std::vector<float> back = texture.download();
    for (std::size_t i = 0; i < values.size(); ++i) {
      EXPECT_NEAR(back[i], values[i], format == TexelFormat::r16 ? 0.5 / 65535 : 0);
    }
  }
}

TEST(Texture, RefusesTheWrongNumberOfValues) {
  gl_context();
  Texture texture("test", TexelFormat::r32f, {3, 2}, TextureFilter::nearest);
  EXPECT_THROW(texture.upload(std::vector<float>(5)), std::logic_error);
}

TEST(Texture, BeyondTheDriversLimitsThrowsWithValueAndLimit) {
  gl_context();
  const std::string side = error_of([] {
    Texture("a wide one", TexelFormat::r8, {100000, 1}, TextureFilter::nearest);
  });
  EXPECT_EQ(side.rfind("a wide one: 100000 texels a side are beyond the driver's limit of ", 0), 0u)
      << side;
  const std::string memory = error_of([] {
    Texture("a heavy one", TexelFormat::r16, {2048, 2048, 1024}, TextureFilter::nearest);
  });
  EXPECT_EQ(
      memory.rfind("a heavy one: needs 8192 MiB of texture memory, beyond the limit of 2048", 0),
      0u)
      << memory;
  EXPECT_NO_THROW(check_gl("after the refusals"));
}

TEST(FragmentProgram, ErrorsContainFileNameAndLog) {
  gl_context();
  EXPECT_EQ(error_of([] { FragmentProgram({"missing.glsl"}, Defines()); }),
            "no shader missing.glsl in this build");
  // Without its binding numbers the shader cannot compile.
  const std::string error = error_of([] { FragmentProgram({"smooth.frag.glsl"}, Defines()); });
  EXPECT_EQ(error.rfind("shader smooth.frag.glsl does not compile:\n", 0), 0u) << error;
  EXPECT_TRUE(holds(error, "BIND_PICTURE"));
}

TEST(FragmentProgram, AMisspelledUniformIsALogicError) {
  gl_context();
  FragmentProgram program(
      {"smooth.frag.glsl"},
      Defines().add("BIND_PICTURE", 0).add("HALF_FILTER", 1).add("BILATERAL", 0));
  EXPECT_NO_THROW(program.set("range_sigma", 1.0));  // optimised away: unused by the box filter
  EXPECT_THROW(program.set("rnage_sigma", 1.0), std::logic_error);
}

TEST(CheckGl, NamesTheErrorAndTheOperation) {
  gl_context();
  check_gl("before");
  Texture texture("test", TexelFormat::r32f, {4, 4}, TextureFilter::nearest);
  // A layer of a 2D texture does not exist.
  const std::string error = error_of([&] {
    try {
      Framebuffer::of_layers({{&texture, 7}});
    } catch (const std::runtime_error&) {
    }
    check_gl("attaching");
  });
  EXPECT_EQ(error.rfind("attaching: GL_INVALID_", 0), 0u) << error;
}

TEST(PassTimer, AccumulatesConsistentTimes) {
  gl_context();
  PassTimer timer;
  PassTime time{"nothing"};
  timer.begin();
  timer.end(time);
  EXPECT_GE(time.gpu_ms, 0);
  EXPECT_GE(time.ms, 0);
  const double once = time.ms;
  Texture texture("test", TexelFormat::rgba32f, {256, 256}, TextureFilter::nearest);
  Texture source("test", TexelFormat::rgba32f, {256, 256}, TextureFilter::nearest);
  FragmentProgram program(
      {"smooth.frag.glsl"},
      Defines().add("BIND_PICTURE", 0).add("HALF_FILTER", 3).add("BILATERAL", 0));
  const Framebuffer target({&texture});
  timer.begin();
  program.draw(target, {{0, &source}});
  timer.end(time);
  EXPECT_GT(time.ms, once);
  EXPECT_GT(time.gpu_ms, 0);
  EXPECT_LE(time.gpu_ms, time.ms + 1);  // a query that reads the time since boot would not
}

}  // namespace
}  // namespace wobblebench::render
