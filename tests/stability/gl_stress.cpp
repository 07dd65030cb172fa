// SPDX-License-Identifier: Apache-2.0
// OpenGL: depths over a ratio of 10^8, and what its driver leaves the drawing thread's processor in. No rows where there is
// no OpenGL.
#include <epoxy/gl.h>

#include "client/gl/depth_convention.h"
#include "client/gl/framebuffer.h"
#include "tests/stability/float_mode.h"
#include "tests/stability/stress.h"

namespace farfield::stability {
namespace {

using namespace client;

// A triangle over the whole image at the distance z, as depth_convention.h wants clip coordinates.
constexpr const char* kVertex = R"(#version 300 es
uniform float z, near_plane, depth_scale, depth_bias;
void main() {
  vec2 corner = vec2(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0);
  gl_Position = vec4(corner * z, depth_scale * near_plane - depth_bias * z, z);
}
)";
constexpr const char* kFragment = R"(#version 300 es
precision highp float;
out vec4 colour;
void main() { colour = vec4(1.0); }
)";

}  // namespace

Rows stress_opengl(const Effort&) {
  const auto context = GlContext::create_surfaceless();
  if (!context) return {};
  const GlAbilities& abilities = (*context)->abilities();
  constexpr int kEdge = 16;
  auto target = Framebuffer::create(abilities, kEdge, kEdge, 1);
  const auto program = Program::build("depth", kVertex, kFragment);
  WorstError depths, modes;
  if (!target || !program) {
    depths.add(INFINITY);
    return {depths.row("a framebuffer and a program", "made", "not", 0)};
  }
  const DepthConvention convention = DepthConvention::of(abilities);
  const float near_plane = 0.01f;
  GLuint no_attributes = 0;
  glGenVertexArrays(1, &no_attributes);
  std::vector<float> shown(kEdge * kEdge);
  for (double z = 0.0101; z < 1.01e6; z *= 1.7) {
    target->begin();
    begin_scene_drawing(abilities);
    program->use();
    glUniform1f(program->uniform("z"), static_cast<float>(z));
    glUniform1f(program->uniform("near_plane"), near_plane);
    glUniform1f(program->uniform("depth_scale"), convention.scale);
    glUniform1f(program->uniform("depth_bias"), convention.bias);
    glBindVertexArray(no_attributes);
    glDrawArrays(GL_TRIANGLES, 0, 3);
    target->resolve();
    target->read_depth(shown);
    // The quotient and the interpolation over the triangle: eight roundings at most, relative to the depth itself if clip z
    // lies in [0, 1], else to 1, as the driver then halves and shifts a number near −1.
    const double exact = static_cast<double>(near_plane) / static_cast<double>(static_cast<float>(z));
    const double bound = 8 * 0x1p-24 * (abilities.has_clip_control ? exact : 1.0);
    for (const float depth : shown) depths.add(depth - exact, bound);
  }
  glDeleteVertexArrays(1, &no_attributes);
  modes.count(!is_thread_ieee());
  return {depths.in_parts_of_bound("OpenGL's depths from 10^-2 to 10^6 m", "near plane / z"),
          modes.row("the thread that drew with OpenGL", "IEEE 754", "not so", 0)};
}

}  // namespace farfield::stability
