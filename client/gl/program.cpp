// SPDX-License-Identifier: Apache-2.0
#include "client/gl/program.h"

#include <epoxy/gl.h>

#include <string>

namespace farfield::client {
namespace {

/// The first line of a log, which is the cause; what follows repeats it.
std::string first_line(std::string log) {
  const std::size_t end = log.find_first_of("\r\n\0");
  if (end != std::string::npos) log.resize(end);
  return log.empty() ? "the driver gave no reason" : log;
}

Result<ShaderName> compile(std::string_view name, GLenum stage, std::string_view source) {
  ShaderName shader(glCreateShader(stage));
  const char* text = source.data();
  const auto length = static_cast<GLint>(source.size());
  glShaderSource(shader.name(), 1, &text, &length);
  glCompileShader(shader.name());
  GLint ok = 0;
  glGetShaderiv(shader.name(), GL_COMPILE_STATUS, &ok);
  if (ok == GL_TRUE) return shader;
  std::string log(4096, '\0');
  GLsizei written = 0;
  glGetShaderInfoLog(shader.name(), static_cast<GLsizei>(log.size()), &written, log.data());
  log.resize(static_cast<std::size_t>(written));
  return fail(ErrorCode::kInternal, "{} {} shader does not compile: {}", name,
              stage == GL_VERTEX_SHADER ? "vertex" : "fragment", first_line(std::move(log)));
}

}  // namespace

Result<Program> Program::build(std::string_view name, std::string_view vertex, std::string_view fragment) {
  Result<ShaderName> vertex_shader = compile(name, GL_VERTEX_SHADER, vertex);
  if (!vertex_shader) return tl::unexpected<Error>(vertex_shader.error());
  Result<ShaderName> fragment_shader = compile(name, GL_FRAGMENT_SHADER, fragment);
  if (!fragment_shader) return tl::unexpected<Error>(fragment_shader.error());
  ProgramName program(glCreateProgram());
  glAttachShader(program.name(), vertex_shader->name());
  glAttachShader(program.name(), fragment_shader->name());
  glLinkProgram(program.name());
  GLint ok = 0;
  glGetProgramiv(program.name(), GL_LINK_STATUS, &ok);
  if (ok != GL_TRUE) {
    std::string log(4096, '\0');
    GLsizei written = 0;
    glGetProgramInfoLog(program.name(), static_cast<GLsizei>(log.size()), &written, log.data());
    log.resize(static_cast<std::size_t>(written));
    return fail(ErrorCode::kInternal, "{} shaders do not link: {}", name, first_line(std::move(log)));
  }
  glDetachShader(program.name(), vertex_shader->name());
  glDetachShader(program.name(), fragment_shader->name());
  return Program(std::move(program));
}

void Program::use() const {
  glUseProgram(name_.name());
}

int Program::uniform(const char* name) const {
  return glGetUniformLocation(name_.name(), name);
}

}  // namespace farfield::client
