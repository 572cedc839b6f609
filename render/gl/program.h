// Fragment programs: a shader file specialised by defines, run over every pixel of a framebuffer.
#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

#include "render/gl/objects.h"
#include "render/passes/region.h"

namespace wobblebench::render {

/// Text of an embedded shader file; empty if there is none of that name. Made at build time.
std::string_view shader_text(std::string_view file);

/// `#define`s put before a shader: how constants and binding numbers are shared with C++.
class Defines {
 public:
  Defines& add(const std::string& name, int value);
  const std::string& text() const { return text_; }

 private:
  std::string text_;
};

/// A texture for a draw; the unit is one of the shader's binding numbers.
struct Binding {
  int unit = 0;
  const Texture* texture = nullptr;
};

/// A layer to read and a layer to draw to.
struct LayerPair {
  int source = 0;
  int target = 0;
};

class FetchCounter;

class FragmentProgram {
 public:
  FragmentProgram() = default;
  /// Whether a program draws to one layer, or to several at once by draw_layers(). Its fragment
  /// shader then has `flat in int source_layer`.
  enum class Layers { one, several };
  /// Compiles the files one after the other as one fragment shader. Throws std::runtime_error with
  /// the file names and the driver's log.
  FragmentProgram(std::initializer_list<std::string_view> files,
                  const Defines& defines,
                  Layers layers = Layers::one);

  /// Uniforms by name. One that the driver has optimised away is ignored; a name that the shader's
  /// text does not hold throws std::logic_error.
  FragmentProgram& set(const std::string& name, int value);
  FragmentProgram& set(const std::string& name, double value);
  FragmentProgram& set(const std::string& name, const glm::dvec2& value);
  FragmentProgram& set(const std::string& name, const glm::dvec3& value);
  FragmentProgram& set(const std::string& name, const std::vector<double>& values);

  /// Draws over the whole framebuffer.
  void draw(const Framebuffer& target, std::initializer_list<Binding> bindings) const;
  /// Draws over a part of several layers of Framebuffer::of_all_layers(), one from each source,
  /// with as few draws as can be: on a CPU each waits for the one before.
  void draw_layers(const Framebuffer& target,
                   std::initializer_list<Binding> bindings,
                   const Region& region,
                   const std::vector<LayerPair>& layers) const;

 private:
  int location(const std::string& name) const;
  void bind(const Framebuffer& target,
            std::initializer_list<Binding> bindings,
            const Region& region) const;

  void count(const Framebuffer& target, std::initializer_list<Binding> bindings) const;

  GlName<delete_program> program_;
  VertexArray no_vertices_;
  std::string source_;
  FetchCounter* counter_ = nullptr;  ///< told what each draw fetches
};

}  // namespace wobblebench::render
