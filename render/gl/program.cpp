#include "render/gl/program.h"

#include <glad/gl.h>

#include <algorithm>
#include <array>
#include <stdexcept>
#include <utility>

#include "render/gl/fetch_count.h"
#include "render/gl/host_state.h"

namespace wobblebench::render {
namespace {

using Shader = GlName<delete_shader>;

constexpr int kMaxLayersPerDraw = 64;

bool draws_one_pixel = false;  ///< one per process, as glad's table of entry points

std::string read_log(GLuint id, decltype(glGetShaderiv) get, decltype(glGetShaderInfoLog) log) {
  GLint length = 0;
  get(id, GL_INFO_LOG_LENGTH, &length);
  std::string text(static_cast<std::size_t>(length), '\0');
  if (length > 0) log(id, length, nullptr, text.data());
  return text;
}

Shader compile(GLenum stage, const std::string& source, const std::string& files) {
  Shader shader(glCreateShader(stage));
  const char* text = source.c_str();
  glShaderSource(shader.id(), 1, &text, nullptr);
  glCompileShader(shader.id());
  GLint compiled = GL_FALSE;
  glGetShaderiv(shader.id(), GL_COMPILE_STATUS, &compiled);
  if (compiled != GL_TRUE) {
    throw std::runtime_error("shader " + files + " does not compile:\n" +
                             read_log(shader.id(), glGetShaderiv, glGetShaderInfoLog));
  }
  return shader;
}

/// Concatenates files. `#line 1 k` makes the driver's log say "k:line" for the k-th file.
std::string assemble(std::initializer_list<std::string_view> files, const std::string& defines) {
  std::string source = "#version 450 core\n" + defines;
  int number = 0;
  for (std::string_view file : files) {
    const std::string_view text = shader_text(file);
    if (text.empty()) throw std::runtime_error("no shader " + std::string(file) + " in this build");
    source += "#line 1 " + std::to_string(number++) + "\n" + std::string(text) + "\n";
  }
  return source;
}

/// The same source with its texture fetches counted.
std::string assemble_counting(std::initializer_list<std::string_view> files,
                              const std::string& defines) {
  std::string before = defines + fetch_count_defines().text();
  before += shader_text("fetch_count.glsl");
  return assemble(files, before) + std::string(shader_text("fetch_total.glsl"));
}

std::string joined(std::initializer_list<std::string_view> files) {
  std::string names;
  for (std::string_view file : files) names += (names.empty() ? "" : " + ") + std::string(file);
  return names;
}

GlName<delete_program> link(std::initializer_list<std::string_view> files,
                            const std::string& source,
                            FragmentProgram::Layers layers) {
  GlName<delete_program> program(glCreateProgram());
  std::vector<Shader> shaders;
  const auto add = [&](GLenum stage, std::string_view file) {
    const std::string text =
        assemble({file}, Defines().add("MAX_LAYERS", kMaxLayersPerDraw).text());
    shaders.push_back(compile(stage, text, std::string(file)));
  };
  if (layers == FragmentProgram::Layers::several) {
    add(GL_VERTEX_SHADER, "layers.vert.glsl");
    add(GL_GEOMETRY_SHADER, "layers.geom.glsl");
  } else {
    add(GL_VERTEX_SHADER, "fullscreen.vert.glsl");
  }
  shaders.push_back(compile(GL_FRAGMENT_SHADER, source, joined(files)));
  for (const Shader& shader : shaders) glAttachShader(program.id(), shader.id());
  glLinkProgram(program.id());
  for (const Shader& shader : shaders) glDetachShader(program.id(), shader.id());
  GLint linked = GL_FALSE;
  glGetProgramiv(program.id(), GL_LINK_STATUS, &linked);
  if (linked != GL_TRUE) {
    throw std::runtime_error("shader " + joined(files) + " does not link:\n" +
                             read_log(program.id(), glGetProgramiv, glGetProgramInfoLog));
  }
  return program;
}

/// Of the context's pool, or linked anew. A fragment shader's source says which vertex shader it
/// goes with: only one for layers reads `source_layer`.
PooledProgram pooled_program(std::initializer_list<std::string_view> files,
                             const std::string& defines,
                             FragmentProgram::Layers layers) {
  std::string source =
      FetchCounter::current() ? assemble_counting(files, defines) : assemble(files, defines);
  const std::shared_ptr<ProgramPool> pool = current_program_pool();
  GlName<delete_program> program = pool ? pool->take(source) : GlName<delete_program>();
  if (!program) program = link(files, source, layers);
  return {pool, std::move(source), std::move(program)};
}

/// A renderer has a dozen; these are those of some ten settings.
constexpr std::size_t kMostIdle = 128;

}  // namespace

DrawsOfOnePixel::DrawsOfOnePixel() {
  draws_one_pixel = true;
}

DrawsOfOnePixel::~DrawsOfOnePixel() {
  draws_one_pixel = false;
}

Defines& Defines::add(const std::string& name, int value) {
  text_ += "#define " + name + " " + std::to_string(value) + "\n";
  return *this;
}

FragmentProgram::FragmentProgram(std::initializer_list<std::string_view> files,
                                 const Defines& defines,
                                 Layers layers)
    : program_(pooled_program(files, defines.text(), layers)),
      no_vertices_(make_vertex_array()),
      counter_(FetchCounter::current()) {}

int FragmentProgram::location(const std::string& name) const {
  const GLint found = glGetUniformLocation(program_.id(), name.c_str());
  if (found < 0 && program_.source().find(name) == std::string::npos) {
    throw std::logic_error("no uniform " + name + " in the shader's text");
  }
  return found;
}

FragmentProgram& FragmentProgram::set(const std::string& name, int value) {
  glProgramUniform1i(program_.id(), location(name), value);
  return *this;
}

FragmentProgram& FragmentProgram::set(const std::string& name, double value) {
  glProgramUniform1f(program_.id(), location(name), static_cast<float>(value));
  return *this;
}

FragmentProgram& FragmentProgram::set(const std::string& name, const glm::dvec2& value) {
  const glm::vec2 v(value);
  glProgramUniform2f(program_.id(), location(name), v.x, v.y);
  return *this;
}

FragmentProgram& FragmentProgram::set(const std::string& name, const glm::dvec3& value) {
  const glm::vec3 v(value);
  glProgramUniform3f(program_.id(), location(name), v.x, v.y, v.z);
  return *this;
}

FragmentProgram& FragmentProgram::set(const std::string& name, const std::vector<double>& values) {
  const std::vector<float> floats(values.begin(), values.end());
  glProgramUniform1fv(
      program_.id(), location(name), static_cast<GLsizei>(floats.size()), floats.data());
  return *this;
}

void FragmentProgram::draw(const Framebuffer& target,
                           std::initializer_list<Binding> bindings) const {
  draw_region(target, bindings, {0, 0, target.width(), target.height()});
}

void FragmentProgram::draw_region(const Framebuffer& target,
                                  std::initializer_list<Binding> bindings,
                                  const Region& region) const {
  bind(target, bindings, region);
  glDrawArrays(GL_TRIANGLES, 0, 3);
  if (counter_) count_fetches(target, bindings);
}

void FragmentProgram::draw_layers(const Framebuffer& target,
                                  std::initializer_list<Binding> bindings,
                                  const Region& region,
                                  const std::vector<LayerPair>& layers) const {
  bind(target, bindings, region);
  for (std::size_t first = 0; first < layers.size(); first += kMaxLayersPerDraw) {
    std::array<GLint, kMaxLayersPerDraw> sources{}, targets{};
    const std::size_t count = std::min<std::size_t>(layers.size() - first, kMaxLayersPerDraw);
    for (std::size_t i = 0; i < count; ++i) {
      sources[i] = layers[first + i].source;
      targets[i] = layers[first + i].target;
    }
    const GLuint id = program_.id();
    glProgramUniform1iv(
        id, glGetUniformLocation(id, "source_layers"), kMaxLayersPerDraw, sources.data());
    glProgramUniform1iv(
        id, glGetUniformLocation(id, "target_layers"), kMaxLayersPerDraw, targets.data());
    glDrawArraysInstanced(GL_TRIANGLES, 0, 3, static_cast<GLsizei>(count));
  }
  if (counter_) count_fetches(target, bindings);
}

void FragmentProgram::bind(const Framebuffer& target,
                           std::initializer_list<Binding> bindings,
                           const Region& region) const {
  glBindFramebuffer(GL_FRAMEBUFFER, target.id());
  glViewportIndexedf(
      0, 0, 0, static_cast<float>(target.width()), static_cast<float>(target.height()));
  glEnablei(GL_SCISSOR_TEST, 0);
  const int columns = draws_one_pixel ? 1 : region.columns;
  const int rows = draws_one_pixel ? 1 : region.rows;
  glScissorIndexed(0, region.column, region.row, columns, rows);
  for (const auto& [unit, texture] : bindings) {
    if (unit >= kTextureUnits) throw std::logic_error("texture unit " + std::to_string(unit));
    glBindTextureUnit(static_cast<GLuint>(unit), texture->id());
  }
  glUseProgram(program_.id());
  glBindVertexArray(no_vertices_.id());
  if (counter_) counter_->begin_draw(target);
}

void FragmentProgram::count_fetches(const Framebuffer& target,
                                    std::initializer_list<Binding> bindings) const {
  std::array<TextureFetch, kSamplers> fetches{};
  std::array<bool, kSamplers> is_set{};
  for (const auto& [unit, texture] : bindings) {
    if (!*texture) continue;  // a pass without it leaves its unit empty
    const TextureFetch fetch = texture_fetch_of(*texture);
    const auto sampler = static_cast<std::size_t>(fetch.sampler);
    if (!std::exchange(is_set[sampler], true)) fetches[sampler] = fetch;
  }
  counter_->end_draw(target, fetches);
}

ProgramPool::~ProgramPool() {
  for (Idle& idle : idle_) idle.program.release();
}

GlName<delete_program> ProgramPool::take(const std::string& source) {
  const auto found = std::find_if(
      idle_.rbegin(), idle_.rend(), [&](const Idle& idle) { return idle.source == source; });
  if (found == idle_.rend()) return {};
  GlName<delete_program> program = std::move(found->program);
  idle_.erase(std::next(found).base());
  return program;
}

void ProgramPool::give_back(std::string source, GlName<delete_program> program) {
  idle_.push_back({std::move(source), std::move(program)});
  if (idle_.size() > kMostIdle) idle_.pop_front();
}

PooledProgram::PooledProgram(std::shared_ptr<ProgramPool> pool,
                             std::string source,
                             GlName<delete_program> program)
    : pool_(std::move(pool)), source_(std::move(source)), program_(std::move(program)) {}

PooledProgram& PooledProgram::operator=(PooledProgram&& other) noexcept {
  if (this == &other) return *this;
  give_back();
  pool_ = std::move(other.pool_);
  source_ = std::move(other.source_);
  program_ = std::move(other.program_);
  return *this;
}

PooledProgram::~PooledProgram() {
  give_back();
}

void PooledProgram::give_back() {
  if (pool_ && program_) pool_->give_back(std::move(source_), std::move(program_));
}

}  // namespace wobblebench::render
