// OpenGL objects as move-only values with an explicit empty state. GL's headers are included in
// .cpp files of this folder only. All calls need a current context (render/gl/context.h).
#pragma once

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <string>
#include <utility>
#include <vector>

#include "render/gl/texels.h"

namespace wobblebench::render {

/// Owner of one GL name; 0 is empty.
template <void (*destroy)(unsigned)>
class GlName {
 public:
  GlName() = default;
  explicit GlName(unsigned id) : id_(id) {}
  GlName(GlName&& other) noexcept : id_(std::exchange(other.id_, 0)) {}
  GlName& operator=(GlName&& other) noexcept {
    if (this != &other) {
      reset();
      id_ = std::exchange(other.id_, 0);
    }
    return *this;
  }
  ~GlName() { reset(); }

  unsigned id() const { return id_; }
  explicit operator bool() const { return id_ != 0; }
  /// Gives the name up without deleting it.
  unsigned release() { return std::exchange(id_, 0); }
  void reset() {
    if (id_ != 0) destroy(std::exchange(id_, 0));
  }

 private:
  unsigned id_ = 0;
};

void delete_texture(unsigned id);
void delete_framebuffer(unsigned id);
void delete_vertex_array(unsigned id);
void delete_program(unsigned id);
void delete_shader(unsigned id);
void delete_query(unsigned id);

using VertexArray = GlName<delete_vertex_array>;
using Query = GlName<delete_query>;
[[nodiscard]] VertexArray make_vertex_array();
[[nodiscard]] Query make_timer_query();

/// Channels of a texel.
int channels(TexelFormat format);

/// Size of a texture or framebuffer, in texels.
struct Extent {
  int width = 1;
  int height = 1;
  int depth = 0;       ///< 0: a 2D texture
  bool array = false;  ///< a 2D array, without filtering between layers; else a 3D texture
};

/// A texture without mip levels, clamped to its edge, cleared to 0. Row 0 is the first row of the
/// data and the top of a picture.
class Texture {
 public:
  Texture() = default;
  /// `what` names the texture in errors. Throws std::runtime_error, before allocating, when a side
  /// or the memory is beyond the driver's limits.
  Texture(const std::string& what, TexelFormat format, Extent extent, TextureFilter filter);

  /// All texels, tightly packed. Throws std::logic_error for a wrong number of values.
  void upload(const std::vector<float>& values);
  void upload(const std::vector<std::uint16_t>& values);
  void upload(const std::vector<std::uint8_t>& values);
  /// One layer of a 3D texture or an array.
  void upload_layer(int layer, const std::vector<float>& values);
  void upload_layer(int layer, const std::vector<std::uint16_t>& values);
  /// All texels as `channels` floats each.
  [[nodiscard]] std::vector<float> download() const;
  /// The same for one layer.
  [[nodiscard]] std::vector<float> download_layer(int layer) const;
  /// The same for the first rows of a 2D texture.
  [[nodiscard]] std::vector<float> download_rows(int rows) const;

  void set_filter(TextureFilter filter) const;
  TextureFilter filter() const;
  TexelFormat format() const { return format_; }

  unsigned id() const { return name_.id(); }
  explicit operator bool() const { return bool(name_); }
  const Extent& extent() const { return extent_; }

 private:
  std::size_t values() const;
  std::vector<float> download_part(int layer, int rows) const;
  void upload_as(unsigned type, const void* data, std::size_t count);
  void upload_layer_as(int layer, unsigned type, const void* data, std::size_t count);

  GlName<delete_texture> name_;
  TexelFormat format_ = TexelFormat::r32f;
  Extent extent_;
};

/// Target of draws: colour attachments 0, 1, … in the order given, which are the output locations
/// of the fragment shader.
class Framebuffer {
 public:
  Framebuffer() = default;
  explicit Framebuffer(const std::vector<const Texture*>& attachments);
  /// Single layers of 3D textures or arrays, one per attachment.
  struct Layer {
    const Texture* texture = nullptr;
    int index = 0;
  };
  static Framebuffer of_layers(const std::vector<Layer>& layers);
  /// All layers of 3D textures or arrays, for FragmentProgram::draw_layers.
  static Framebuffer of_all_layers(std::initializer_list<const Texture*> textures);

  unsigned id() const { return name_.id(); }
  explicit operator bool() const { return bool(name_); }
  int width() const { return extent_.width; }
  int height() const { return extent_.height; }
  const Extent& extent() const { return extent_; }

  /// Attaches one more texture of the same extent at this colour attachment, behind the others;
  /// null detaches it.
  void attach(int slot, const Texture* texture) const;

 private:
  void finish(const Extent& extent, int attachments);

  GlName<delete_framebuffer> name_;
  Extent extent_{0, 0};
  int attachments_ = 0;
};

/// Throws std::runtime_error with `where` and the GL errors since the last check, if any;
/// ContextLost (render/gl/context.h) if the driver says so.
void check_gl(const std::string& where);

/// While one exists on this thread, objects (render/gl/objects.h) forget their names instead of
/// deleting them, which would delete another context's. The names go with their context.
class ForgetNames {
 public:
  ForgetNames();
  ~ForgetNames();
  ForgetNames(const ForgetNames&) = delete;
  ForgetNames& operator=(const ForgetNames&) = delete;
};

}  // namespace wobblebench::render
