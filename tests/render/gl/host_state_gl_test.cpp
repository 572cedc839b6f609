// The renderer in the context of another program: its state changes no picture, and is given back.
#include "render/gl/host_state.h"

#include <glad/gl.h>
#include <gtest/gtest.h>

#include "render/gl/objects.h"
#include "render/gl/program.h"
#include "render/renderer.h"
#include "tests/render/support/agreement.h"
#include "tests/render/support/gl_state.h"
#include "tests/render/support/synthetic.h"

namespace wobblebench::render {
namespace {

using testing::difference;
using testing::gl_state;
using Names = std::vector<std::string>;

GLuint buffer_of(GLsizeiptr bytes) {
  GLuint id = 0;
  glCreateBuffers(1, &id);
  glNamedBufferStorage(id, bytes, nullptr, GL_DYNAMIC_STORAGE_BIT);
  return id;
}

/// A program that captures its only output by transform feedback.
GLuint make_program() {
  const char* text =
      "#version 450 core\n"
      "out float captured;\n"
      "void main() { captured = 1.0; gl_Position = vec4(0); }\n";
  const GLuint shader = glCreateShader(GL_VERTEX_SHADER);
  glShaderSource(shader, 1, &text, nullptr);
  glCompileShader(shader);
  const GLuint program = glCreateProgram();
  glAttachShader(program, shader);
  const char* captured = "captured";
  glTransformFeedbackVaryings(program, 1, &captured, GL_INTERLEAVED_ATTRIBS);
  glLinkProgram(program);
  return program;
}

void set_layout(std::initializer_list<GLenum> names, GLint value) {
  for (const GLenum name : names) glPixelStorei(name, value);
}

void bind_samplers() {
  GLuint sampler = 0;
  glCreateSamplers(1, &sampler);
  glSamplerParameteri(sampler, GL_TEXTURE_MIN_FILTER, GL_NEAREST_MIPMAP_NEAREST);
  glSamplerParameteri(sampler, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  glSamplerParameteri(sampler, GL_TEXTURE_WRAP_S, GL_MIRRORED_REPEAT);
  glSamplerParameteri(sampler, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_BORDER);
  glSamplerParameterf(sampler, GL_TEXTURE_LOD_BIAS, 4);
  for (GLuint unit = 0; unit < 8; ++unit) glBindSampler(unit, sampler);
}

void bind_textures() {
  for (GLuint unit = 0; unit < 8; ++unit) {
    for (const GLenum target : {GL_TEXTURE_1D, GL_TEXTURE_2D, GL_TEXTURE_3D, GL_TEXTURE_2D_ARRAY}) {
      GLuint texture = 0;
      glCreateTextures(target, 1, &texture);
      glBindTextureUnit(unit, texture);
    }
  }
  glActiveTexture(GL_TEXTURE3);
}

void bind_framebuffers() {
  GLuint ids[3] = {};
  glCreateFramebuffers(3, ids);
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, ids[0]);
  glBindFramebuffer(GL_READ_FRAMEBUFFER, ids[1]);
}

void bind_vertices() {
  GLuint array = 0;
  glCreateVertexArrays(1, &array);
  glBindVertexArray(array);
  glVertexArrayElementBuffer(array, buffer_of(64));
  glBindBuffer(GL_ARRAY_BUFFER, buffer_of(64));
  glEnableVertexAttribArray(0);
}

void use_pipeline() {
  GLuint pipeline = 0;
  glCreateProgramPipelines(1, &pipeline);
  glBindProgramPipeline(pipeline);
}

void begin_transform_feedback() {
  glBindBufferBase(GL_TRANSFORM_FEEDBACK_BUFFER, 0, buffer_of(1024));
  glUseProgram(make_program());
  glBeginTransformFeedback(GL_TRIANGLES);
}

void write_elsewhere() {
  for (const GLenum test : {GL_BLEND, GL_COLOR_LOGIC_OP, GL_SCISSOR_TEST, GL_FRAMEBUFFER_SRGB}) {
    glEnable(test);
  }
  glBlendFunc(GL_ONE, GL_ONE);
  glEnablei(GL_BLEND, 1);
  glBlendFunci(1, GL_ZERO, GL_ONE);
  glColorMask(GL_FALSE, GL_TRUE, GL_FALSE, GL_FALSE);
  glColorMaski(1, GL_FALSE, GL_FALSE, GL_TRUE, GL_TRUE);
  glLogicOp(GL_INVERT);
  glScissor(3, 4, 5, 6);
  glViewport(1, 2, 3, 4);
  glDisable(GL_DITHER);
}

void cover_fewer_pixels() {
  for (const GLenum test : {GL_POLYGON_SMOOTH,
                            GL_POLYGON_OFFSET_FILL,
                            GL_CULL_FACE,
                            GL_RASTERIZER_DISCARD,
                            GL_PRIMITIVE_RESTART}) {
    glEnable(test);
  }
  glPolygonMode(GL_FRONT_AND_BACK, GL_LINE);
  glPolygonOffset(3, 5);
  glCullFace(GL_FRONT_AND_BACK);
  glFrontFace(GL_CW);
  glPrimitiveRestartIndex(1);
  for (GLenum i = 0; i < 8; ++i) glEnable(GL_CLIP_DISTANCE0 + i);
  glClipControl(GL_UPPER_LEFT, GL_ZERO_TO_ONE);
  glProvokingVertex(GL_FIRST_VERTEX_CONVENTION);
}

void reject_fragments() {
  for (const GLenum test : {GL_DEPTH_TEST, GL_DEPTH_CLAMP, GL_STENCIL_TEST}) glEnable(test);
  glDepthFunc(GL_NEVER);
  glDepthMask(GL_FALSE);
  glDepthRange(0.9, 0.2);
  glStencilFunc(GL_NEVER, 1, 1);
  glStencilMask(0);
}

void reject_samples() {
  for (const GLenum test : {GL_SAMPLE_MASK,
                            GL_SAMPLE_COVERAGE,
                            GL_SAMPLE_ALPHA_TO_COVERAGE,
                            GL_SAMPLE_ALPHA_TO_ONE,
                            GL_SAMPLE_SHADING}) {
    glEnable(test);
  }
  glSampleMaski(0, 0);
  glSampleCoverage(0, GL_FALSE);
  glMinSampleShading(1);
  glDisable(GL_MULTISAMPLE);
}

void lay_out_pixels() {
  set_layout({GL_UNPACK_SKIP_PIXELS, GL_UNPACK_SKIP_ROWS, GL_UNPACK_SKIP_IMAGES}, 1);
  set_layout({GL_UNPACK_ROW_LENGTH, GL_UNPACK_IMAGE_HEIGHT}, 7);
  set_layout({GL_UNPACK_SWAP_BYTES, GL_UNPACK_LSB_FIRST}, 1);
  set_layout({GL_PACK_SKIP_PIXELS, GL_PACK_SKIP_ROWS, GL_PACK_SKIP_IMAGES}, 1);
  set_layout({GL_PACK_ROW_LENGTH, GL_PACK_IMAGE_HEIGHT}, 7);
  set_layout({GL_PACK_SWAP_BYTES, GL_PACK_LSB_FIRST}, 1);
  set_layout({GL_UNPACK_ALIGNMENT, GL_PACK_ALIGNMENT}, 8);
}

void bind_buffers() {
  glBindBuffer(GL_PIXEL_UNPACK_BUFFER, buffer_of(1 << 22));
  glBindBuffer(GL_PIXEL_PACK_BUFFER, buffer_of(1 << 22));
}

struct Hostile {
  const char* name;
  void (*set)();
};

/// States of a row do not hide each other: one that a renderer keeps changes its picture, where the
/// others of the row are reset.
constexpr Hostile kStates[] = {
    {"writes", write_elsewhere},
    {"coverage", cover_fewer_pixels},
    {"fragments", reject_fragments},
    {"samples", reject_samples},
    {"layout", lay_out_pixels},
    {"buffers", bind_buffers},
    {"samplers", bind_samplers},
    {"textures", bind_textures},
    {"framebuffers", bind_framebuffers},
    {"vertices", bind_vertices},
    {"program", [] { glUseProgram(make_program()); }},
    {"program_pipeline", use_pipeline},
    {"pending_error", [] { glEnable(0xBAD); }},
    {"transform_feedback", begin_transform_feedback},
};

RenderOptions options_of(PipelineMode mode) {
  RenderOptions options = testing::small_options();
  options.pipeline.mode = mode;
  return options;
}

constexpr ViewOptions kTurned = {.yaw_rad = 20 * kDegree};

/// The pictures from the front and from the side; `after` is called after each of the renderer's
/// calls.
template <class After>
std::vector<Picture> pictures(GlContext& context, PipelineMode mode, const After& after) {
  const hw::PolarVolume& volume = testing::noisy_scene();
  std::vector<Picture> made;
  {
    Renderer renderer(context, volume.plan(), options_of(mode));
    after("constructor");
    renderer.add_volume(volume);
    renderer.update();
    after("update");
    made.push_back(renderer.render());
    after("render");
    renderer.set_view(kTurned);
    after("set_view");
    made.push_back(renderer.render());
  }
  after("destructor");
  return made;
}

const std::vector<Picture>& clean_pictures(PipelineMode mode) {
  static std::map<PipelineMode, std::vector<Picture>> made;
  if (!made.contains(mode)) {
    const auto context = make_context();
    made[mode] = pictures(*context, mode, [](const char*) {});
  }
  return made[mode];
}

void expect_clean(const std::vector<Picture>& made, PipelineMode mode) {
  const std::vector<Picture>& clean = clean_pictures(mode);
  ASSERT_EQ(made.size(), clean.size());
  for (std::size_t i = 0; i < made.size(); ++i) {
    EXPECT_GT(testing::hits(clean[i].depth_m), 500);
    testing::expect_same_bits(made[i], clean[i]);
  }
}

/// Renders in the current context, whose state the host has set.
void expect_good_guest(GlContext& context, PipelineMode mode) {
  const testing::GlState before = gl_state();
  const auto made = pictures(context, mode, [&](const char* call) {
    EXPECT_EQ(difference(before, gl_state()), Names{}) << "after " << call;
  });
  EXPECT_EQ(glGetError(), GLenum{GL_NO_ERROR});
  expect_clean(made, mode);
}

class HostStateOf : public ::testing::TestWithParam<Hostile> {};

TEST_P(HostStateOf, ChangesNoPictureAndIsGivenBack) {
  clean_pictures(PipelineMode::fast);
  const auto context = make_context();
  GetParam().set();
  expect_good_guest(*context, PipelineMode::fast);
}

INSTANTIATE_TEST_SUITE_P(HostState,
                         HostStateOf,
                         ::testing::ValuesIn(kStates),
                         [](const auto& test) { return test.param.name; });

class HostStateIn : public ::testing::TestWithParam<PipelineMode> {};

TEST_P(HostStateIn, AllTogetherChangesNoPictureAndIsGivenBack) {
  clean_pictures(GetParam());
  const auto context = make_context();
  for (const Hostile& state : kStates) state.set();
  expect_good_guest(*context, GetParam());
}

INSTANTIATE_TEST_SUITE_P(HostState,
                         HostStateIn,
                         ::testing::Values(PipelineMode::plain, PipelineMode::fast),
                         [](const auto& test) {
                           return test.param == PipelineMode::fast ? "fast" : "plain";
                         });

TEST(HostState, ATimerQueryOfTheHostKeepsRunning) {
  const auto context = make_context();
  GLuint query = 0;
  glCreateQueries(GL_TIME_ELAPSED, 1, &query);
  glBeginQuery(GL_TIME_ELAPSED, query);
  const auto made = pictures(*context, PipelineMode::fast, [](const char*) {});
  expect_clean(made, PipelineMode::fast);
  context->make_current();
  GLint running = 0;
  glGetQueryiv(GL_TIME_ELAPSED, GL_CURRENT_QUERY, &running);
  EXPECT_EQ(running, static_cast<GLint>(query));
  EXPECT_LT(made[0].passes[1].gpu_ms, 0);
  EXPECT_GT(made[0].passes[1].ms, 0);
  glEndQuery(GL_TIME_ELAPSED);
  EXPECT_EQ(glGetError(), GLenum{GL_NO_ERROR});
}

/// The host's textures are saved of the units that a draw may use.
TEST(HostState, CoversTheUnitsOfAllPrograms) {
  const auto context = make_context();
  const Texture from("from", TexelFormat::r32f, {1, 1}, TextureFilter::nearest);
  const Texture to("to", TexelFormat::r32f, {1, 1}, TextureFilter::nearest);
  const FragmentProgram program(
      {"smooth.frag.glsl"},
      Defines().add("BIND_PICTURE", 0).add("HALF_FILTER", 1).add("BILATERAL", 0));
  const Framebuffer target({&to});
  EXPECT_NO_THROW(program.draw(target, {{kTextureUnits - 1, &from}}));
  EXPECT_THROW(program.draw(target, {{kTextureUnits, &from}}), std::logic_error);
}

}  // namespace
}  // namespace wobblebench::render
