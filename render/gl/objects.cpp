#include "render/gl/objects.h"

#include <glad/gl.h>

#include <algorithm>
#include <stdexcept>

#include "render/gl/context.h"

namespace wobblebench::render {
namespace {

thread_local bool forgets_names = false;

struct FormatInfo {
  GLenum internal;
  GLenum transfer;
  int channels;
  int bytes;
};

FormatInfo info(TexelFormat format) {
  switch (format) {
    case TexelFormat::r8:
      return {GL_R8, GL_RED, 1, 1};
    case TexelFormat::r16:
      return {GL_R16, GL_RED, 1, 2};
    case TexelFormat::r32f:
      return {GL_R32F, GL_RED, 1, 4};
    case TexelFormat::rg8:
      return {GL_RG8, GL_RG, 2, 2};
    case TexelFormat::rg16:
      return {GL_RG16, GL_RG, 2, 4};
    case TexelFormat::rg32f:
      return {GL_RG32F, GL_RG, 2, 8};
    case TexelFormat::rgba8:
      return {GL_RGBA8, GL_RGBA, 4, 4};
    case TexelFormat::rgba16:
      return {GL_RGBA16, GL_RGBA, 4, 8};
    case TexelFormat::rgb32f:
      return {GL_RGB32F, GL_RGB, 3, 12};
    case TexelFormat::rgba32f:
      return {GL_RGBA32F, GL_RGBA, 4, 16};
  }
  throw std::logic_error("TexelFormat: no such format");
}

int integer_limit(GLenum name) {
  GLint value = 0;
  glGetIntegerv(name, &value);
  return value;
}

std::string driver() {
  return reinterpret_cast<const char*>(glGetString(GL_RENDERER));
}

/// llvmpipe reports textures beyond 2 GiB only when they are used, so the size is checked here, for
/// all drivers alike.
constexpr std::int64_t kTextureMemoryLimit = std::int64_t{2} << 30;

void check_limits(const std::string& what, TexelFormat format, const Extent& e) {
  const bool is_3d = e.depth && !e.array;
  const int side_limit = integer_limit(is_3d ? GL_MAX_3D_TEXTURE_SIZE : GL_MAX_TEXTURE_SIZE);
  const int layer_limit =
      integer_limit(is_3d ? GL_MAX_3D_TEXTURE_SIZE : GL_MAX_ARRAY_TEXTURE_LAYERS);
  for (const auto& [side, limit] : {std::pair(e.width, side_limit),
                                    std::pair(e.height, side_limit),
                                    std::pair(e.depth, layer_limit)}) {
    if (side <= limit) continue;
    throw std::runtime_error(what + ": " + std::to_string(side) +
                             " texels a side are beyond the driver's limit of " +
                             std::to_string(limit) + " (" + driver() + ")");
  }
  const std::int64_t bytes =
      std::int64_t{e.width} * e.height * (e.depth ? e.depth : 1) * info(format).bytes;
  if (bytes > kTextureMemoryLimit) {
    throw std::runtime_error(what + ": needs " + std::to_string(bytes >> 20) +
                             " MiB of texture memory, beyond the limit of " +
                             std::to_string(kTextureMemoryLimit >> 20) + " MiB (" + driver() + ")");
  }
}

const char* reset_reason(GLenum reset) {
  switch (reset) {
    case GL_GUILTY_CONTEXT_RESET:
      return "the GPU was reset because of it";
    case GL_INNOCENT_CONTEXT_RESET:
      return "the GPU was reset because of another program";
    default:
      return "the driver gives no reason";
  }
}

const char* error_name(GLenum error) {
  switch (error) {
    case GL_INVALID_ENUM:
      return "GL_INVALID_ENUM";
    case GL_INVALID_VALUE:
      return "GL_INVALID_VALUE";
    case GL_INVALID_OPERATION:
      return "GL_INVALID_OPERATION";
    case GL_INVALID_FRAMEBUFFER_OPERATION:
      return "GL_INVALID_FRAMEBUFFER_OPERATION";
    case GL_OUT_OF_MEMORY:
      return "GL_OUT_OF_MEMORY";
    case GL_CONTEXT_LOST:
      return "GL_CONTEXT_LOST";
    default:
      return "unknown GL error";
  }
}

}  // namespace

ForgetNames::ForgetNames() {
  forgets_names = true;
}

ForgetNames::~ForgetNames() {
  forgets_names = false;
}

void delete_texture(unsigned id) {
  if (!forgets_names) glDeleteTextures(1, &id);
}
void delete_framebuffer(unsigned id) {
  if (!forgets_names) glDeleteFramebuffers(1, &id);
}
void delete_vertex_array(unsigned id) {
  if (!forgets_names) glDeleteVertexArrays(1, &id);
}
void delete_program(unsigned id) {
  if (!forgets_names) glDeleteProgram(id);
}
void delete_shader(unsigned id) {
  if (!forgets_names) glDeleteShader(id);
}
void delete_query(unsigned id) {
  if (!forgets_names) glDeleteQueries(1, &id);
}

VertexArray make_vertex_array() {
  GLuint id = 0;
  glCreateVertexArrays(1, &id);
  return VertexArray(id);
}

Query make_timer_query() {
  GLuint id = 0;
  glCreateQueries(GL_TIME_ELAPSED, 1, &id);
  return Query(id);
}

int channels(TexelFormat format) {
  return info(format).channels;
}

Texture::Texture(const std::string& what, TexelFormat format, Extent extent, TextureFilter filter)
    : format_(format), extent_(extent) {
  check_limits(what, format, extent);
  GLuint id = 0;
  const GLenum layered = extent.array ? GL_TEXTURE_2D_ARRAY : GL_TEXTURE_3D;
  glCreateTextures(extent.depth ? layered : GL_TEXTURE_2D, 1, &id);
  name_ = GlName<delete_texture>(id);
  const GLenum internal = info(format).internal;
  if (extent.depth) {
    glTextureStorage3D(id, 1, internal, extent.width, extent.height, extent.depth);
  } else {
    glTextureStorage2D(id, 1, internal, extent.width, extent.height);
  }
  set_filter(filter);
  for (GLenum parameter : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T, GL_TEXTURE_WRAP_R}) {
    glTextureParameteri(id, parameter, GL_CLAMP_TO_EDGE);
  }
  glClearTexImage(id, 0, info(format).transfer, GL_FLOAT, nullptr);
  check_gl(what);
}

void Texture::set_filter(TextureFilter filter) const {
  const GLint mode = filter == TextureFilter::linear ? GL_LINEAR : GL_NEAREST;
  for (GLenum parameter : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER}) {
    glTextureParameteri(id(), parameter, mode);
  }
}

TextureFilter Texture::filter() const {
  GLint mode = GL_NEAREST;
  glGetTextureParameteriv(id(), GL_TEXTURE_MIN_FILTER, &mode);
  return mode == GL_LINEAR ? TextureFilter::linear : TextureFilter::nearest;
}

std::size_t Texture::values() const {
  return static_cast<std::size_t>(extent_.width) * static_cast<std::size_t>(extent_.height) *
         static_cast<std::size_t>(extent_.depth ? extent_.depth : 1) *
         static_cast<std::size_t>(channels(format_));
}

void Texture::upload_as(unsigned type, const void* data, std::size_t count) {
  if (count != values()) {
    throw std::logic_error("Texture::upload: " + std::to_string(count) + " values for " +
                           std::to_string(values()));
  }
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  const GLenum transfer = info(format_).transfer;
  if (extent_.depth) {
    glTextureSubImage3D(
        id(), 0, 0, 0, 0, extent_.width, extent_.height, extent_.depth, transfer, type, data);
  } else {
    glTextureSubImage2D(id(), 0, 0, 0, extent_.width, extent_.height, transfer, type, data);
  }
}

void Texture::upload(const std::vector<float>& values) {
  upload_as(GL_FLOAT, values.data(), values.size());
}

void Texture::upload(const std::vector<std::uint16_t>& values) {
  upload_as(GL_UNSIGNED_SHORT, values.data(), values.size());
}

void Texture::upload(const std::vector<std::uint8_t>& values) {
  upload_as(GL_UNSIGNED_BYTE, values.data(), values.size());
}

void Texture::upload_layer_as(int layer, unsigned type, const void* data, std::size_t count) {
  const std::size_t expected = values() / static_cast<std::size_t>(extent_.depth);
  if (count != expected) {
    throw std::logic_error("Texture::upload_layer: " + std::to_string(count) + " values for " +
                           std::to_string(expected));
  }
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  const GLenum transfer = info(format_).transfer;
  glTextureSubImage3D(id(), 0, 0, 0, layer, extent_.width, extent_.height, 1, transfer, type, data);
}

void Texture::upload_layer(int layer, const std::vector<float>& values) {
  upload_layer_as(layer, GL_FLOAT, values.data(), values.size());
}

void Texture::upload_layer(int layer, const std::vector<std::uint16_t>& values) {
  upload_layer_as(layer, GL_UNSIGNED_SHORT, values.data(), values.size());
}

std::vector<float> Texture::download() const {
  std::vector<float> texels(values());
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glGetTextureImage(id(),
                    0,
                    info(format_).transfer,
                    GL_FLOAT,
                    static_cast<GLsizei>(texels.size() * sizeof(float)),
                    texels.data());
  return texels;
}

std::vector<float> Texture::download_layer(int layer) const {
  return download_part(layer, extent_.height);
}

std::vector<float> Texture::download_rows(int rows) const {
  return download_part(0, rows);
}

std::vector<float> Texture::download_part(int layer, int rows) const {
  std::vector<float> texels(static_cast<std::size_t>(extent_.width) *
                            static_cast<std::size_t>(rows) *
                            static_cast<std::size_t>(channels(format_)));
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glGetTextureSubImage(id(),
                       0,
                       0,
                       0,
                       layer,
                       extent_.width,
                       rows,
                       1,
                       info(format_).transfer,
                       GL_FLOAT,
                       static_cast<GLsizei>(texels.size() * sizeof(float)),
                       texels.data());
  return texels;
}

Framebuffer::Framebuffer(const std::vector<const Texture*>& attachments) {
  GLuint id = 0;
  glCreateFramebuffers(1, &id);
  name_ = GlName<delete_framebuffer>(id);
  GLenum slot = GL_COLOR_ATTACHMENT0;
  for (const Texture* texture : attachments) {
    glNamedFramebufferTexture(id, slot++, texture->id(), 0);
  }
  finish(attachments.front()->extent(), static_cast<int>(attachments.size()));
}

Framebuffer Framebuffer::of_layers(const std::vector<Layer>& layers) {
  GLuint id = 0;
  glCreateFramebuffers(1, &id);
  Framebuffer framebuffer;
  framebuffer.name_ = GlName<delete_framebuffer>(id);
  GLenum slot = GL_COLOR_ATTACHMENT0;
  for (const Layer& layer : layers) {
    glNamedFramebufferTextureLayer(id, slot++, layer.texture->id(), 0, layer.index);
  }
  const Extent& extent = layers.front().texture->extent();
  framebuffer.finish({extent.width, extent.height}, static_cast<int>(layers.size()));
  return framebuffer;
}

Framebuffer Framebuffer::of_all_layers(std::initializer_list<const Texture*> textures) {
  return Framebuffer(textures);  // attaching a texture without naming a layer attaches all
}

void Framebuffer::attach(int slot, const Texture* texture) const {
  const GLenum attachment = GL_COLOR_ATTACHMENT0 + static_cast<GLenum>(slot);
  glNamedFramebufferTexture(id(), attachment, texture ? texture->id() : 0, 0);
  std::vector<GLenum> slots(static_cast<std::size_t>(slot) + 1, GL_NONE);
  for (int i = 0; i < attachments_; ++i) {
    slots.at(static_cast<std::size_t>(i)) = GL_COLOR_ATTACHMENT0 + static_cast<GLenum>(i);
  }
  if (texture) slots.back() = attachment;
  glNamedFramebufferDrawBuffers(id(), static_cast<GLsizei>(slots.size()), slots.data());
}

void Framebuffer::finish(const Extent& extent, int attachments) {
  extent_ = extent;
  attachments_ = attachments;
  std::vector<GLenum> slots;
  for (int i = 0; i < attachments; ++i)
    slots.push_back(GL_COLOR_ATTACHMENT0 + static_cast<GLenum>(i));
  glNamedFramebufferDrawBuffers(id(), attachments, slots.data());
  const GLenum status = glCheckNamedFramebufferStatus(id(), GL_FRAMEBUFFER);
  if (status != GL_FRAMEBUFFER_COMPLETE) {
    throw std::runtime_error("framebuffer is incomplete, status " + std::to_string(status));
  }
}

void check_gl(const std::string& where) {
  std::string errors;
  for (GLenum error = glGetError(); error != GL_NO_ERROR; error = glGetError()) {
    errors += std::string(errors.empty() ? "" : ", ") + error_name(error);
    if (errors.size() > 200) break;  // a lost context reports errors without end
  }
  const GLenum reset = glGetGraphicsResetStatus();
  if (reset != GL_NO_ERROR || errors.find("GL_CONTEXT_LOST") != std::string::npos) {
    throw ContextLost(where + ": the OpenGL context is lost: " + reset_reason(reset));
  }
  if (!errors.empty()) throw std::runtime_error(where + ": " + errors);
}

}  // namespace wobblebench::render
