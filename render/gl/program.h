// Fragment programs: shader files specialised by #defines, run over every pixel of a framebuffer.
#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

#include "render/gl/objects.h"
#include "render/gl/program_pool.h"
#include "render/gl/region.h"

namespace wobblebench::render {

/// Text of a shader file, embedded at build time (cmake/EmbedText.cmake); empty if there is none of
/// that name.
std::string_view shader_text(std::string_view file);

/// `#define`s prepended to a shader: constants and binding numbers shared with C++.
class Defines {
 public:
  Defines& add(const std::string& name, int value);
  const std::string& text() const { return text_; }

 private:
  std::string text_;
};

/// A texture bound to one of the shader's binding numbers for a draw.
struct Binding {
  int unit = 0;
  const Texture* texture = nullptr;
};

/// A layer to read from and a layer to draw to.
struct LayerPair {
  int source = 0;
  int target = 0;
};

/// While one exists, each draw covers one pixel: for drivers that compile a program when it is
/// first drawn with, as llvmpipe does.
class DrawsOfOnePixel {
 public:
  DrawsOfOnePixel();
  ~DrawsOfOnePixel();
  DrawsOfOnePixel(const DrawsOfOnePixel&) = delete;
  DrawsOfOnePixel& operator=(const DrawsOfOnePixel&) = delete;
};

class FetchCounter;

/// A linked GL program with the fragment shader given and a vertex shader that covers the target;
/// default-constructed: empty.
class FragmentProgram {
 public:
  FragmentProgram() = default;
  /// `several`: draws by draw_layers(), and the fragment shader declares `flat in int
  /// source_layer`.
  enum class Layers { one, several };
  /// Compiles the files, concatenated, as one fragment shader, unless the context has the program
  /// (render/gl/program_pool.h): all uniforms are to be set. Throws std::runtime_error with the
  /// file names and the driver's log.
  FragmentProgram(std::initializer_list<std::string_view> files,
                  const Defines& defines,
                  Layers layers = Layers::one);

  explicit operator bool() const { return bool(program_); }

  /// Sets a uniform by name. One that the driver has optimised away is ignored; a name that does
  /// not occur in the shader's text throws std::logic_error.
  FragmentProgram& set(const std::string& name, int value);
  FragmentProgram& set(const std::string& name, double value);
  FragmentProgram& set(const std::string& name, const glm::dvec2& value);
  FragmentProgram& set(const std::string& name, const glm::dvec3& value);
  FragmentProgram& set(const std::string& name, const std::vector<double>& values);

  /// Draws over the whole framebuffer.
  void draw(const Framebuffer& target, std::initializer_list<Binding> bindings) const;
  /// Draws over a region of several layers of Framebuffer::of_all_layers(), each from its source
  /// layer, in as few draws as possible: on llvmpipe a draw waits for the one before.
  void draw_layers(const Framebuffer& target,
                   std::initializer_list<Binding> bindings,
                   const Region& region,
                   const std::vector<LayerPair>& layers) const;

 private:
  int location(const std::string& name) const;
  void bind(const Framebuffer& target,
            std::initializer_list<Binding> bindings,
            const Region& region) const;
  void count_fetches(const Framebuffer& target, std::initializer_list<Binding> bindings) const;

  PooledProgram program_;
  VertexArray no_vertices_;
  FetchCounter* counter_ = nullptr;  ///< null: fetches are not counted
};

}  // namespace wobblebench::render
