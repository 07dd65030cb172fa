// SPDX-License-Identifier: Apache-2.0
#include "client/near/surface_program.h"

#include <epoxy/gl.h>

#include <cstddef>
#include <glm/gtc/type_ptr.hpp>
#include <string>

namespace farfield::client {
namespace {

constexpr const char* kVertexBody = R"(
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 radiance;
out vec3 surface_radiance;
layout(location = 2) in vec2 uv;
uniform vec3 eye;
uniform mat3 camera_from_frame;
uniform vec2 inverse_tangents;
uniform vec2 depth;  // DepthConvention: scale times near plane, bias
#ifdef TEXTURED
out vec2 surface_uv;
#endif
void main() {
  vec3 q = camera_from_frame * (position - eye);
  float w = -q.z;
  gl_Position = vec4(q.xy * inverse_tangents, depth.x - depth.y * w, w);
  surface_radiance = radiance;
#ifdef TEXTURED
  surface_uv = uv;
#endif
}
)";

// The level of detail is common/shading's mip_level: from the area, not the longer axis, of a pixel's footprint.
constexpr const char* kFragmentBody = R"(
in vec3 surface_radiance;
layout(location = 0) out vec4 colour;
#ifdef TEXTURED
in vec2 surface_uv;
uniform highp sampler2D surface_texture;
uniform float alpha_cutoff;
#endif
void main() {
  vec3 result = surface_radiance;
#ifdef TEXTURED
  vec2 dx = dFdx(surface_uv);
  vec2 dy = dFdy(surface_uv);
  vec2 size = vec2(textureSize(surface_texture, 0));
  float texel_area = abs(dx.x * dy.y - dx.y * dy.x) * size.x * size.y;
  float level = texel_area > 1.0 ? 0.5 * log2(texel_area) : 0.0;
  vec4 texel = textureLod(surface_texture, surface_uv, level);
  result *= texel.rgb;
#endif
  colour = vec4(result, 1.0);
#ifdef MASKED
  if (textureLod(surface_texture, surface_uv, 0.0).a < alpha_cutoff) discard;
#endif
}
)";

}  // namespace

Result<SurfacePrograms> SurfacePrograms::build() {
  SurfacePrograms result;
  for (int i = 0; i < static_cast<int>(result.variants_.size()); ++i) {
    const bool is_textured = i & 1, is_masked = i & 2;
    if (is_masked && !is_textured) continue;
    std::string head = "#version 300 es\nprecision highp float;\n";
    if (is_textured) head += "#define TEXTURED\n";
    if (is_masked) head += "#define MASKED\n";
    Result<Program> program = Program::build("near geometry", head + kVertexBody, head + kFragmentBody);
    if (!program) return tl::unexpected<Error>(program.error());
    Variant& v = result.variants_[static_cast<std::size_t>(i)];
    v.program = std::move(*program);
    v.eye = v.program.uniform("eye");
    v.camera_from_frame = v.program.uniform("camera_from_frame");
    v.inverse_tangents = v.program.uniform("inverse_tangents");
    v.depth = v.program.uniform("depth");
    v.cutoff = v.program.uniform("alpha_cutoff");
    v.program.use();
    glUniform1i(v.program.uniform("surface_texture"), 0);
  }
  return result;
}

void SurfacePrograms::begin_frame(const ViewTransform& view, const glm::dvec3& frame_centre,
                                  const DepthConvention& depth) {
  frame_.eye = glm::vec3(view.eye - frame_centre);
  frame_.camera_from_frame = glm::mat3(view.camera_from_scene);
  frame_.inverse_tangents = {1 / view.tan_x, 1 / view.tan_y};
  frame_.depth = {depth.scale * view.near_plane_m, depth.bias};
  for (Variant& v : variants_) v.is_current = false;
}

void SurfacePrograms::use(const SurfaceVariant& variant, float alpha_cutoff) {
  Variant& v = variants_[static_cast<std::size_t>(variant.index())];
  v.program.use();
  if (variant.is_alpha_masked) glUniform1f(v.cutoff, alpha_cutoff);
  if (v.is_current) return;
  v.is_current = true;
  glUniform3fv(v.eye, 1, glm::value_ptr(frame_.eye));
  glUniformMatrix3fv(v.camera_from_frame, 1, GL_FALSE, glm::value_ptr(frame_.camera_from_frame));
  glUniform2fv(v.inverse_tangents, 1, glm::value_ptr(frame_.inverse_tangents));
  glUniform2fv(v.depth, 1, glm::value_ptr(frame_.depth));
}

VertexArrayName make_surface_vertex_array(const Buffer& vertices, const Buffer& indices) {
  VertexArrayName array = VertexArrayName::make();
  glBindVertexArray(array.name());
  glBindBuffer(GL_ARRAY_BUFFER, vertices.name());
  glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, indices.name());
  const auto at = [](std::size_t offset) { return reinterpret_cast<const void*>(offset); };
  glEnableVertexAttribArray(0);
  glVertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, sizeof(SurfaceVertex), at(offsetof(SurfaceVertex, position)));
  glEnableVertexAttribArray(1);
  glVertexAttribPointer(1, 3, GL_UNSIGNED_SHORT, GL_TRUE, sizeof(SurfaceVertex), at(offsetof(SurfaceVertex, radiance)));
  glEnableVertexAttribArray(2);
  glVertexAttribPointer(2, 2, GL_FLOAT, GL_FALSE, sizeof(SurfaceVertex), at(offsetof(SurfaceVertex, uv)));
  glBindVertexArray(0);
  return array;
}

}  // namespace farfield::client
