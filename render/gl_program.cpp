#include "render/gl_program.h"

#include <glad/gl.h>

#include <stdexcept>

namespace wobblebench::render {
namespace {

using Shader = GlName<delete_shader>;

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

/// One source of several files. `#line 1 k` makes the driver's log say "k:line" of the k-th file.
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

std::string joined(std::initializer_list<std::string_view> files) {
  std::string names;
  for (std::string_view file : files) names += (names.empty() ? "" : " + ") + std::string(file);
  return names;
}

}  // namespace

Defines& Defines::add(const std::string& name, int value) {
  text_ += "#define " + name + " " + std::to_string(value) + "\n";
  return *this;
}

FragmentProgram::FragmentProgram(std::initializer_list<std::string_view> files,
                                 const Defines& defines)
    : program_(glCreateProgram()),
      no_vertices_(make_vertex_array()),
      source_(assemble(files, defines.text())) {
  const Shader vertex =
      compile(GL_VERTEX_SHADER, assemble({"fullscreen.vert.glsl"}, ""), "fullscreen.vert.glsl");
  const Shader fragment = compile(GL_FRAGMENT_SHADER, source_, joined(files));
  for (GLuint shader : {vertex.id(), fragment.id()}) glAttachShader(program_.id(), shader);
  glLinkProgram(program_.id());
  for (GLuint shader : {vertex.id(), fragment.id()}) glDetachShader(program_.id(), shader);
  GLint linked = GL_FALSE;
  glGetProgramiv(program_.id(), GL_LINK_STATUS, &linked);
  if (linked != GL_TRUE) {
    throw std::runtime_error("shader " + joined(files) + " does not link:\n" +
                             read_log(program_.id(), glGetProgramiv, glGetProgramInfoLog));
  }
}

int FragmentProgram::location(const std::string& name) const {
  const GLint found = glGetUniformLocation(program_.id(), name.c_str());
  if (found < 0 && source_.find(name) == std::string::npos) {
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
  glBindFramebuffer(GL_FRAMEBUFFER, target.id());
  glViewport(0, 0, target.width(), target.height());
  for (const auto& [unit, texture] : bindings) {
    glBindTextureUnit(static_cast<GLuint>(unit), texture->id());
  }
  glUseProgram(program_.id());
  glBindVertexArray(no_vertices_.id());
  glDrawArrays(GL_TRIANGLES, 0, 3);
}

}  // namespace wobblebench::render
