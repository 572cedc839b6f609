#include "tests/render/support/gl_state.h"

#include <glad/gl.h>

#include <array>

namespace wobblebench::render::testing {
namespace {

struct Name {
  GLenum value;
  const char* text;
};

#define NAME(constant)  \
  Name {                \
    constant, #constant \
  }

constexpr std::array kSwitches = {NAME(GL_BLEND),
                                  NAME(GL_COLOR_LOGIC_OP),
                                  NAME(GL_CULL_FACE),
                                  NAME(GL_DEPTH_CLAMP),
                                  NAME(GL_DEPTH_TEST),
                                  NAME(GL_DITHER),
                                  NAME(GL_FRAMEBUFFER_SRGB),
                                  NAME(GL_LINE_SMOOTH),
                                  NAME(GL_MULTISAMPLE),
                                  NAME(GL_POLYGON_OFFSET_FILL),
                                  NAME(GL_POLYGON_SMOOTH),
                                  NAME(GL_PRIMITIVE_RESTART),
                                  NAME(GL_PRIMITIVE_RESTART_FIXED_INDEX),
                                  NAME(GL_PROGRAM_POINT_SIZE),
                                  NAME(GL_RASTERIZER_DISCARD),
                                  NAME(GL_SAMPLE_ALPHA_TO_COVERAGE),
                                  NAME(GL_SAMPLE_ALPHA_TO_ONE),
                                  NAME(GL_SAMPLE_COVERAGE),
                                  NAME(GL_SAMPLE_MASK),
                                  NAME(GL_SAMPLE_SHADING),
                                  NAME(GL_STENCIL_TEST),
                                  NAME(GL_TEXTURE_CUBE_MAP_SEAMLESS)};

constexpr std::array kValues = {NAME(GL_ACTIVE_TEXTURE),
                                NAME(GL_ARRAY_BUFFER_BINDING),
                                NAME(GL_BLEND_COLOR),
                                NAME(GL_CLIP_DEPTH_MODE),
                                NAME(GL_CLIP_ORIGIN),
                                NAME(GL_COLOR_CLEAR_VALUE),
                                NAME(GL_COPY_READ_BUFFER_BINDING),
                                NAME(GL_COPY_WRITE_BUFFER_BINDING),
                                NAME(GL_CULL_FACE_MODE),
                                NAME(GL_CURRENT_PROGRAM),
                                NAME(GL_DEPTH_CLEAR_VALUE),
                                NAME(GL_DEPTH_FUNC),
                                NAME(GL_DEPTH_RANGE),
                                NAME(GL_DEPTH_WRITEMASK),
                                NAME(GL_DRAW_FRAMEBUFFER_BINDING),
                                NAME(GL_DRAW_INDIRECT_BUFFER_BINDING),
                                NAME(GL_ELEMENT_ARRAY_BUFFER_BINDING),
                                NAME(GL_FRONT_FACE),
                                NAME(GL_LINE_WIDTH),
                                NAME(GL_LOGIC_OP_MODE),
                                NAME(GL_MIN_SAMPLE_SHADING_VALUE),
                                NAME(GL_PACK_ALIGNMENT),
                                NAME(GL_PACK_IMAGE_HEIGHT),
                                NAME(GL_PACK_LSB_FIRST),
                                NAME(GL_PACK_ROW_LENGTH),
                                NAME(GL_PACK_SKIP_IMAGES),
                                NAME(GL_PACK_SKIP_PIXELS),
                                NAME(GL_PACK_SKIP_ROWS),
                                NAME(GL_PACK_SWAP_BYTES),
                                NAME(GL_PIXEL_PACK_BUFFER_BINDING),
                                NAME(GL_PIXEL_UNPACK_BUFFER_BINDING),
                                NAME(GL_POLYGON_MODE),
                                NAME(GL_POLYGON_OFFSET_FACTOR),
                                NAME(GL_PRIMITIVE_RESTART_INDEX),
                                NAME(GL_PROGRAM_PIPELINE_BINDING),
                                NAME(GL_PROVOKING_VERTEX),
                                NAME(GL_READ_FRAMEBUFFER_BINDING),
                                NAME(GL_RENDERBUFFER_BINDING),
                                NAME(GL_SAMPLE_COVERAGE_INVERT),
                                NAME(GL_SAMPLE_COVERAGE_VALUE),
                                NAME(GL_STENCIL_FUNC),
                                NAME(GL_STENCIL_WRITEMASK),
                                NAME(GL_TRANSFORM_FEEDBACK_ACTIVE),
                                NAME(GL_TRANSFORM_FEEDBACK_PAUSED),
                                NAME(GL_UNIFORM_BUFFER_BINDING),
                                NAME(GL_UNPACK_ALIGNMENT),
                                NAME(GL_UNPACK_IMAGE_HEIGHT),
                                NAME(GL_UNPACK_LSB_FIRST),
                                NAME(GL_UNPACK_ROW_LENGTH),
                                NAME(GL_UNPACK_SKIP_IMAGES),
                                NAME(GL_UNPACK_SKIP_PIXELS),
                                NAME(GL_UNPACK_SKIP_ROWS),
                                NAME(GL_UNPACK_SWAP_BYTES),
                                NAME(GL_VERTEX_ARRAY_BINDING)};

constexpr std::array kOfDrawBuffers = {NAME(GL_COLOR_WRITEMASK),
                                       NAME(GL_BLEND_SRC_RGB),
                                       NAME(GL_BLEND_DST_ALPHA),
                                       NAME(GL_BLEND_EQUATION_RGB)};

constexpr std::array kOfViewports = {NAME(GL_VIEWPORT), NAME(GL_SCISSOR_BOX), NAME(GL_DEPTH_RANGE)};

constexpr std::array kOfUnits = {NAME(GL_TEXTURE_BINDING_1D),
                                 NAME(GL_TEXTURE_BINDING_2D),
                                 NAME(GL_TEXTURE_BINDING_3D),
                                 NAME(GL_TEXTURE_BINDING_2D_ARRAY),
                                 NAME(GL_TEXTURE_BINDING_CUBE_MAP),
                                 NAME(GL_TEXTURE_BINDING_BUFFER),
                                 NAME(GL_SAMPLER_BINDING)};

#undef NAME

constexpr GLuint kDrawBuffers = 8, kViewports = 16, kUnits = 16, kClipDistances = 8;

std::string indexed(const Name& name, GLuint index) {
  return std::string(name.text) + "[" + std::to_string(index) + "]";
}

void add_units(GlState& state) {
  GLint active = 0;
  glGetIntegerv(GL_ACTIVE_TEXTURE, &active);
  for (GLuint unit = 0; unit < kUnits; ++unit) {
    glActiveTexture(GL_TEXTURE0 + unit);
    for (const Name& name : kOfUnits) {
      GLint value = 0;
      glGetIntegerv(name.value, &value);
      state[indexed(name, unit)] = {double(value)};
    }
  }
  glActiveTexture(static_cast<GLenum>(active));
}

void add_indexed(GlState& state, const Name& name, GLuint count) {
  for (GLuint i = 0; i < count; ++i) {
    std::array<GLdouble, 4> values{};
    glGetDoublei_v(name.value, i, values.data());
    state[indexed(name, i)] = {values.begin(), values.end()};
  }
}

void add_indexed_switch(GlState& state, const Name& name, GLuint count) {
  for (GLuint i = 0; i < count; ++i) {
    state[indexed(name, i)] = {double(glIsEnabledi(name.value, i))};
  }
}

}  // namespace

GlState gl_state() {
  GlState state;
  for (const Name& name : kSwitches) state[name.text] = {double(glIsEnabled(name.value))};
  for (const Name& name : kValues) {
    std::array<GLdouble, 16> values{};
    glGetDoublev(name.value, values.data());
    state[name.text] = {values.begin(), values.end()};
  }
  for (const Name& name : kOfDrawBuffers) add_indexed(state, name, kDrawBuffers);
  for (const Name& name : kOfViewports) add_indexed(state, name, kViewports);
  add_indexed_switch(state, {GL_BLEND, "GL_BLEND"}, kDrawBuffers);
  add_indexed_switch(state, {GL_SCISSOR_TEST, "GL_SCISSOR_TEST"}, kViewports);
  for (GLuint i = 0; i < kClipDistances; ++i) {
    state["GL_CLIP_DISTANCE" + std::to_string(i)] = {double(glIsEnabled(GL_CLIP_DISTANCE0 + i))};
  }
  std::array<GLint, 1> mask{};
  glGetIntegeri_v(GL_SAMPLE_MASK_VALUE, 0, mask.data());
  state["GL_SAMPLE_MASK_VALUE"] = {double(mask[0])};
  add_units(state);
  return state;
}

std::vector<std::string> difference(const GlState& before, const GlState& after) {
  std::vector<std::string> names;
  for (const auto& [name, values] : before) {
    if (after.at(name) != values) names.push_back(name);
  }
  return names;
}

}  // namespace wobblebench::render::testing
