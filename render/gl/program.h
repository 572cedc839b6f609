// Fragment programs: shader files specialised by #defines, run over every pixel of a framebuffer;
// linked programs wait in their context for the next renderer.
#pragma once

#include <cstddef>
#include <deque>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <initializer_list>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "render/gl/objects.h"
#include "render/gl/texels.h"

namespace wobblebench::render {

/// Linked programs of one context that no FragmentProgram holds, by their source. A driver that
/// compiles at the first draw, as llvmpipe does, takes longer for a program than for a picture.
/// Uniforms keep the values of the last user: the next one sets all of them.
class ProgramPool {
 public:
  ProgramPool() = default;
  /// The names go with the context.
  ~ProgramPool();
  ProgramPool(const ProgramPool&) = delete;
  ProgramPool& operator=(const ProgramPool&) = delete;

  /// The program that was given back last with this source; empty if there is none.
  GlName<delete_program> take(const std::string& source);
  /// Deletes the one that waits longest if there are too many.
  void give_back(std::string source, GlName<delete_program> program);

 private:
  struct Idle {
    std::string source;
    GlName<delete_program> program;
  };
  std::deque<Idle> idle_;  ///< in the order of their return
};

/// A program that goes back to its pool in the end.
class PooledProgram {
 public:
  PooledProgram() = default;
  PooledProgram(std::shared_ptr<ProgramPool> pool,
                std::string source,
                GlName<delete_program> program);
  PooledProgram(PooledProgram&&) noexcept = default;
  PooledProgram& operator=(PooledProgram&& other) noexcept;
  ~PooledProgram();

  unsigned id() const { return program_.id(); }
  explicit operator bool() const { return bool(program_); }
  const std::string& source() const { return source_; }

 private:
  void give_back();

  std::shared_ptr<ProgramPool> pool_;
  std::string source_;
  GlName<delete_program> program_;
};

/// That of this thread's current context; null without one.
std::shared_ptr<ProgramPool> current_program_pool();

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
  /// (ProgramPool): all uniforms are to be set. Throws std::runtime_error with the
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
  /// Draws over a region of the framebuffer.
  void draw_region(const Framebuffer& target,
                   std::initializer_list<Binding> bindings,
                   const Region& region) const;
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
