// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/baselines/panel_renderer.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <array>

#include "client/gl/depth_convention.h"

namespace farfield::bench {
namespace {

constexpr const char* kVertex = R"(#version 300 es
precision highp float;
layout(location = 0) in vec3 sample_point;  // u, v, disparity in 1/side
uniform mat3 camera_from_face;
uniform vec3 shift;             // from the eye to the view, in sides, in the camera's axes
uniform vec2 inverse_tangents;
uniform vec2 depth;             // DepthConvention: scale times near plane over side, bias
uniform vec2 texture_from_tangent;
centroid out vec2 texture_place;
void main() {
  vec3 q = camera_from_face * vec3(sample_point.xy, 1.0) + sample_point.z * shift;
  float w = -q.z;
  gl_Position = vec4(q.xy * inverse_tangents, depth.x * max(sample_point.z, 1e-30) - depth.y * w, w);
  texture_place = sample_point.xy * texture_from_tangent.x + texture_from_tangent.y;
}
)";

constexpr const char* kFragment = R"(#version 300 es
precision highp float;
centroid in vec2 texture_place;
uniform sampler2D image;
layout(location = 0) out vec4 colour;
void main() { colour = vec4(texture(image, texture_place).rgb, 254.0 / 255.0); }
)";

/// What is drawn of surfaces that near geometry shows too (far_view.h) must lie behind it: by more than the 0.4 % of
/// its disparity that a pixel of simplification is at the border of the near region.
constexpr double kBehindNear = 0.99;

/// Squares along a face's edge whose triangles are culled together, as Farfield culls its tiles.
constexpr int kRunsAlong = 8;

glm::vec3 sample_point(const ViewFrame& frame, const FaceVertex& v) {
  return {frame.u(v.column - 0.5), frame.u(v.row - 0.5), v.disparity};
}

/// Indices sorted by the square that triangles begin in, and where each square's begin.
std::vector<std::uint32_t> sorted_by_square(const FaceMesh& mesh, int edge, std::array<std::size_t, kRunsAlong * kRunsAlong + 1>& starts) {
  const auto square = [&](std::size_t t) {
    const FaceVertex& v = mesh.vertices[mesh.indices[3 * t]];
    const auto place = [&](float at) { return std::clamp(static_cast<int>(at * kRunsAlong / static_cast<float>(edge)), 0, kRunsAlong - 1); };
    return static_cast<std::size_t>(place(v.row) * kRunsAlong + place(v.column));
  };
  starts.fill(0);
  for (std::size_t t = 0; t < mesh.triangles(); ++t) starts[square(t) + 1] += 3;
  for (std::size_t s = 0; s + 1 < starts.size(); ++s) starts[s + 1] += starts[s];
  std::vector<std::uint32_t> sorted(mesh.indices.size());
  auto next = starts;
  for (std::size_t t = 0; t < mesh.triangles(); ++t) {
    std::size_t& at = next[square(t)];
    for (std::size_t c = 0; c < 3; ++c) sorted[at++] = mesh.indices[3 * t + c];
  }
  return sorted;
}

}  // namespace

Result<PanelRenderer> PanelRenderer::create(const client::GlAbilities& abilities) {
  Result<client::Program> program = client::Program::build("panel", kVertex, kFragment);
  if (!program) return tl::unexpected(program.error());
  PanelRenderer result;
  result.abilities_ = abilities;
  result.program_ = std::move(*program);
  return result;
}

PanelRenderer::Held PanelRenderer::hold(const MeshPanel& panel) {
  Held held;
  held.frame = panel.frame;
  std::vector<glm::vec3> points;
  for (const FaceVertex& v : panel.mesh.vertices) points.push_back(sample_point(panel.frame, v));
  std::array<std::size_t, kRunsAlong * kRunsAlong + 1> starts;
  const std::vector<std::uint32_t> indices = sorted_by_square(panel.mesh, panel.frame.edge_samples, starts);
  for (std::size_t s = 0; s + 1 < starts.size(); ++s) {
    Run run{starts[s], starts[s + 1] - starts[s], glm::dvec3(1e30), glm::dvec3(-1e30)};
    if (run.count == 0) continue;
    for (std::size_t i = starts[s]; i < starts[s + 1]; ++i)
      run.low = glm::min(run.low, glm::dvec3(points[indices[i]])), run.high = glm::max(run.high, glm::dvec3(points[indices[i]]));
    held.runs.push_back(run);
  }
  held.vertices = client::Buffer::make(points.size() * sizeof(glm::vec3));
  held.vertices.write(0, std::as_bytes(std::span(points)));
  held.indices = client::Buffer::make(indices.size() * sizeof(std::uint32_t));
  held.indices.write(0, std::as_bytes(std::span(indices)));
  held.array = client::VertexArrayName::make();
  glBindVertexArray(held.array.name());
  glBindBuffer(GL_ARRAY_BUFFER, held.vertices.name());
  glEnableVertexAttribArray(0);
  glVertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, sizeof(glm::vec3), nullptr);
  glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, held.indices.name());
  glBindVertexArray(0);

  std::vector<std::uint8_t> rgba;
  rgba.reserve(panel.rgb.size() / 3 * 4);
  for (std::size_t k = 0; k < panel.rgb.size(); k += 3) rgba.insert(rgba.end(), {panel.rgb[k], panel.rgb[k + 1], panel.rgb[k + 2], 255});
  held.texture = client::TextureName::make();
  glBindTexture(GL_TEXTURE_2D, held.texture.name());
  const int edge = panel.frame.edge_samples;
  glTexImage2D(GL_TEXTURE_2D, 0, GL_SRGB8_ALPHA8, edge, edge, 0, GL_RGBA, GL_UNSIGNED_BYTE, rgba.data());
  glGenerateMipmap(GL_TEXTURE_2D);
  // Towards a face's corners samples lie twice as dense as pixels; between levels nothing is blended, which would blur.
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_NEAREST);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
  return held;
}

void PanelRenderer::upload(std::span<const MeshPanel> panels) {
  held_.clear();
  uploaded_ = panels.size();
  for (std::size_t k = 0; k < panels.size(); ++k) {
    if (panels[k].mesh.indices.empty()) continue;
    held_.push_back(hold(panels[k]));
    held_.back().panel = k;
  }
}

PanelRenderer::Placed PanelRenderer::place(const Held& held, const client::ViewTransform& view) {
  glm::dmat3 scene_from_face(0);
  scene_from_face[0][held.frame.face.u_axis()] = 1, scene_from_face[1][held.frame.face.v_axis()] = 1;
  scene_from_face[2][held.frame.face.axis] = held.frame.face.sign;
  return {view.camera_from_scene * scene_from_face, view.camera_from_scene * ((held.frame.position - view.eye) / held.frame.side_m)};
}

std::vector<PanelRenderer::Run> PanelRenderer::runs_in_view(const Held& held, const Placed& placed, const client::ViewTransform& view) {
  std::vector<Run> visible;
  for (const Run& run : held.runs) {
    const glm::dvec3 middle = 0.5 * (run.low + run.high), half = 0.5 * (run.high - run.low);
    const client::AffineBox box{placed.camera_from_face * glm::dvec3(middle.x, middle.y, 1) + middle.z * placed.shift,
                                glm::dmat3(placed.camera_from_face[0] * half.x, placed.camera_from_face[1] * half.y, placed.shift * half.z)};
    if (!view.may_see(box)) continue;
    if (!visible.empty() && visible.back().first_index + visible.back().count == run.first_index) visible.back().count += run.count;
    else visible.push_back(run);
  }
  return visible;
}

std::vector<std::size_t> PanelRenderer::triangles_in_view(const client::ViewTransform& view) const {
  std::vector<std::size_t> triangles(uploaded_, 0);
  for (const Held& held : held_)
    for (const Run& run : runs_in_view(held, place(held, view), view)) triangles[held.panel] += run.count / 3;
  return triangles;
}

std::size_t PanelRenderer::draw(const client::ViewTransform& view, std::span<const std::uint8_t> is_shown) {
  client::begin_scene_drawing(abilities_);
  program_.use();
  const client::DepthConvention depth = client::DepthConvention::of(abilities_);
  glUniform2f(program_.uniform("inverse_tangents"), static_cast<float>(1 / view.tan_x), static_cast<float>(1 / view.tan_y));
  glUniform1i(program_.uniform("image"), 0);
  glActiveTexture(GL_TEXTURE0);
  std::size_t triangles = 0;
  for (const Held& held : held_) {
    if (!is_shown.empty() && is_shown[held.panel] == 0) continue;
    const Placed placed = place(held, view);
    const std::vector<Run> visible = runs_in_view(held, placed, view);
    if (visible.empty()) continue;
    for (const Run& run : visible) triangles += run.count / 3;
    const glm::mat3 matrix(placed.camera_from_face);
    const glm::vec3 shift(placed.shift);
    glUniformMatrix3fv(program_.uniform("camera_from_face"), 1, GL_FALSE, &matrix[0][0]);
    glUniform3f(program_.uniform("shift"), shift.x, shift.y, shift.z);
    glUniform2f(program_.uniform("depth"), static_cast<float>(kBehindNear * depth.scale * view.near_plane_m / held.frame.side_m), depth.bias);
    // Sample i is at u = -1 + (i - ½)·pitch; its texel's centre at (i + ½)/N.
    const double scale = 1 / (held.frame.pitch * held.frame.edge_samples);
    glUniform2f(program_.uniform("texture_from_tangent"), static_cast<float>(scale), static_cast<float>(scale + 1.0 / held.frame.edge_samples));
    glBindTexture(GL_TEXTURE_2D, held.texture.name());
    glBindVertexArray(held.array.name());
    for (const Run& run : visible)
      glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(run.count), GL_UNSIGNED_INT, reinterpret_cast<const void*>(run.first_index * sizeof(std::uint32_t)));
  }
  glBindVertexArray(0);
  return triangles;
}

}  // namespace farfield::bench
