#include "render/gl/host_state.h"

#include <glad/gl.h>

#include <stdexcept>

#include "render/gl/context.h"
#include "render/gl/objects.h"

namespace wobblebench::render {
namespace {

/// What the renderer needs disabled. Depth and stencil tests, multisampling and sRGB conversion
/// have no effect on its framebuffers as OpenGL is specified; drivers are not always.
constexpr std::array kDisabled = {GL_CULL_FACE,
                                  GL_DEPTH_TEST,
                                  GL_STENCIL_TEST,
                                  GL_DEPTH_CLAMP,
                                  GL_DITHER,
                                  GL_COLOR_LOGIC_OP,
                                  GL_RASTERIZER_DISCARD,
                                  GL_POLYGON_SMOOTH,
                                  GL_POLYGON_OFFSET_FILL,
                                  GL_PRIMITIVE_RESTART,
                                  GL_PRIMITIVE_RESTART_FIXED_INDEX,
                                  GL_FRAMEBUFFER_SRGB,
                                  GL_SAMPLE_ALPHA_TO_COVERAGE,
                                  GL_SAMPLE_ALPHA_TO_ONE,
                                  GL_SAMPLE_COVERAGE,
                                  GL_SAMPLE_MASK,
                                  GL_SAMPLE_SHADING,
                                  GL_MULTISAMPLE,
                                  GL_PROGRAM_POINT_SIZE,
                                  GL_CLIP_DISTANCE0,
                                  GL_CLIP_DISTANCE1,
                                  GL_CLIP_DISTANCE2,
                                  GL_CLIP_DISTANCE3,
                                  GL_CLIP_DISTANCE4,
                                  GL_CLIP_DISTANCE5,
                                  GL_CLIP_DISTANCE6,
                                  GL_CLIP_DISTANCE7};

/// Layout of data in client memory, 0 for tightly packed; alignments are 1.
constexpr std::array kPixelLayout = {GL_UNPACK_ALIGNMENT,
                                     GL_PACK_ALIGNMENT,
                                     GL_UNPACK_SWAP_BYTES,
                                     GL_PACK_SWAP_BYTES,
                                     GL_UNPACK_LSB_FIRST,
                                     GL_PACK_LSB_FIRST,
                                     GL_UNPACK_ROW_LENGTH,
                                     GL_PACK_ROW_LENGTH,
                                     GL_UNPACK_IMAGE_HEIGHT,
                                     GL_PACK_IMAGE_HEIGHT,
                                     GL_UNPACK_SKIP_PIXELS,
                                     GL_PACK_SKIP_PIXELS,
                                     GL_UNPACK_SKIP_ROWS,
                                     GL_PACK_SKIP_ROWS,
                                     GL_UNPACK_SKIP_IMAGES,
                                     GL_PACK_SKIP_IMAGES};

/// Targets that glBindTextureUnit binds to, and their bindings.
constexpr std::array kTextureTargets = {GL_TEXTURE_2D, GL_TEXTURE_3D, GL_TEXTURE_2D_ARRAY};
constexpr std::array kTextureBindings = {
    GL_TEXTURE_BINDING_2D, GL_TEXTURE_BINDING_3D, GL_TEXTURE_BINDING_2D_ARRAY};

int integer(GLenum name) {
  GLint value = 0;
  glGetIntegerv(name, &value);
  return value;
}

bool boolean(GLenum name) {
  GLboolean value = GL_FALSE;
  glGetBooleanv(name, &value);
  return value == GL_TRUE;
}

GLenum texture_unit(std::size_t unit) {
  return GL_TEXTURE0 + static_cast<GLenum>(unit);
}

int needed_layout(std::size_t store) {
  return store < 2 ? 1 : 0;
}

/// Drops the errors that the host left. Throws ContextLost.
void drop_errors() {
  try {
    check_gl("before rendering");
  } catch (const ContextLost&) {
    throw;
  } catch (const std::runtime_error&) {
    return;  // the host's: it has not asked for them
  }
}

}  // namespace

HostState::HostState() {
  drop_errors();
  save_bindings();
  pause_transform_feedback();
  clear_switches();
  clear_draw_buffers();
  clear_pixel_stores();
  clear_rasterizer();
}

HostState::~HostState() {
  restore_rasterizer();
  restore_pixel_stores();
  restore_draw_buffers();
  restore_switches();
  restore_bindings();
  if (paused_transform_feedback_) glResumeTransformFeedback();
}

void HostState::save_bindings() {
  draw_framebuffer_ = integer(GL_DRAW_FRAMEBUFFER_BINDING);
  read_framebuffer_ = integer(GL_READ_FRAMEBUFFER_BINDING);
  vertex_array_ = integer(GL_VERTEX_ARRAY_BINDING);
  program_ = integer(GL_CURRENT_PROGRAM);
  unpack_buffer_ = integer(GL_PIXEL_UNPACK_BUFFER_BINDING);
  pack_buffer_ = integer(GL_PIXEL_PACK_BUFFER_BINDING);
  active_texture_ = integer(GL_ACTIVE_TEXTURE);
  for (std::size_t i = 0; i < units_.size(); ++i) {
    glActiveTexture(texture_unit(i));
    for (std::size_t t = 0; t < kTextureBindings.size(); ++t) {
      units_[i].textures[t] = integer(kTextureBindings[t]);
    }
    units_[i].sampler = integer(GL_SAMPLER_BINDING);
    if (units_[i].sampler) glBindSampler(static_cast<GLuint>(i), 0);
  }
  if (unpack_buffer_) glBindBuffer(GL_PIXEL_UNPACK_BUFFER, 0);
  if (pack_buffer_) glBindBuffer(GL_PIXEL_PACK_BUFFER, 0);
}

void HostState::restore_bindings() const {
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, static_cast<GLuint>(draw_framebuffer_));
  glBindFramebuffer(GL_READ_FRAMEBUFFER, static_cast<GLuint>(read_framebuffer_));
  glBindVertexArray(static_cast<GLuint>(vertex_array_));
  // One that the host deleted while it was current ends when another becomes current.
  const auto program = static_cast<GLuint>(program_);
  glUseProgram(glIsProgram(program) ? program : 0);
  for (std::size_t i = 0; i < units_.size(); ++i) {
    glActiveTexture(texture_unit(i));
    for (std::size_t t = 0; t < kTextureTargets.size(); ++t) {
      glBindTexture(kTextureTargets[t], static_cast<GLuint>(units_[i].textures[t]));
    }
    if (units_[i].sampler) {
      glBindSampler(static_cast<GLuint>(i), static_cast<GLuint>(units_[i].sampler));
    }
  }
  glActiveTexture(static_cast<GLenum>(active_texture_));
  if (unpack_buffer_) {
    glBindBuffer(GL_PIXEL_UNPACK_BUFFER, static_cast<GLuint>(unpack_buffer_));
  }
  if (pack_buffer_) glBindBuffer(GL_PIXEL_PACK_BUFFER, static_cast<GLuint>(pack_buffer_));
}

/// Else no other program could be used, and it would capture the renderer's draws.
void HostState::pause_transform_feedback() {
  paused_transform_feedback_ =
      boolean(GL_TRANSFORM_FEEDBACK_ACTIVE) && !boolean(GL_TRANSFORM_FEEDBACK_PAUSED);
  if (paused_transform_feedback_) glPauseTransformFeedback();
}

void HostState::clear_switches() {
  static_assert(kDisabled.size() == kSwitches);
  for (std::size_t i = 0; i < kSwitches; ++i) {
    switches_[i] = glIsEnabled(kDisabled[i]) == GL_TRUE;
    if (switches_[i]) glDisable(kDisabled[i]);
  }
}

void HostState::restore_switches() const {
  for (std::size_t i = 0; i < kSwitches; ++i) {
    if (switches_[i]) glEnable(kDisabled[i]);
  }
}

void HostState::clear_draw_buffers() {
  for (GLuint i = 0; i < kDrawBuffers; ++i) {
    blends_[i] = glIsEnabledi(GL_BLEND, i) == GL_TRUE;
    if (blends_[i]) glDisablei(GL_BLEND, i);
    glGetBooleani_v(GL_COLOR_WRITEMASK, i, color_masks_[i].data());
    glColorMaski(i, GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  }
}

void HostState::restore_draw_buffers() const {
  for (GLuint i = 0; i < kDrawBuffers; ++i) {
    if (blends_[i]) glEnablei(GL_BLEND, i);
    const auto& mask = color_masks_[i];
    glColorMaski(i, mask[0], mask[1], mask[2], mask[3]);
  }
}

void HostState::clear_pixel_stores() {
  static_assert(kPixelLayout.size() == kPixelStores);
  for (std::size_t i = 0; i < kPixelStores; ++i) {
    pixel_stores_[i] = integer(kPixelLayout[i]);
    if (pixel_stores_[i] != needed_layout(i)) glPixelStorei(kPixelLayout[i], needed_layout(i));
  }
}

void HostState::restore_pixel_stores() const {
  for (std::size_t i = 0; i < kPixelStores; ++i) {
    if (pixel_stores_[i] != needed_layout(i)) glPixelStorei(kPixelLayout[i], pixel_stores_[i]);
  }
}

void HostState::clear_rasterizer() {
  glGetFloati_v(GL_VIEWPORT, 0, rectangle_.viewport.data());
  glGetIntegeri_v(GL_SCISSOR_BOX, 0, rectangle_.scissor.data());
  rectangle_.is_scissored = glIsEnabledi(GL_SCISSOR_TEST, 0) == GL_TRUE;
  glGetIntegerv(GL_POLYGON_MODE, polygon_mode_.data());
  glPolygonMode(GL_FRONT_AND_BACK, GL_FILL);
  clip_control_ = {integer(GL_CLIP_ORIGIN), integer(GL_CLIP_DEPTH_MODE)};
  glClipControl(GL_LOWER_LEFT, GL_NEGATIVE_ONE_TO_ONE);
}

void HostState::restore_rasterizer() const {
  glViewportIndexedfv(0, rectangle_.viewport.data());
  glScissorIndexedv(0, rectangle_.scissor.data());
  const auto set = rectangle_.is_scissored ? glEnablei : glDisablei;
  set(GL_SCISSOR_TEST, 0);
  glPolygonMode(GL_FRONT_AND_BACK, static_cast<GLenum>(polygon_mode_[0]));
  glClipControl(static_cast<GLenum>(clip_control_[0]), static_cast<GLenum>(clip_control_[1]));
}

}  // namespace wobblebench::render
