// SPDX-License-Identifier: Apache-2.0
#include "client/warp_gl/impostor_renderer.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <tuple>
#include <vector>

#include "client/gl/depth_convention.h"
#include "client/gl/program.h"
#include "client/warp_gl/impostor_store.h"

namespace farfield::client {
namespace {

// By how much nearer delta views count, as a share of the disparity: what they hold of a surface that an earlier view sees
// too, that view sees obliquely. More than coding makes the two differ by there. (The CPU warper compares footprints.)
constexpr double kDeltaPreference = 1.0 / 512.0;

constexpr const char* kVertex = R"(#version 300 es
precision highp float;
precision highp int;
layout(location = 0) in vec3 sample_point;  // u, v, disparity in 1/side
layout(location = 1) in vec4 place;         // column and row in sixteenths of a texel, layer, row of the view table
uniform highp sampler2D views;
uniform vec2 inverse_tangents;
uniform vec2 texels_to_unit;                // 1/16 over the layer's size
uniform vec2 depth;                         // DepthConvention: scale times near plane, bias
uniform float side;
centroid out vec3 texture_place;  // never beyond the outline
void main() {
  int view = int(place.w);
  vec4 column0 = texelFetch(views, ivec2(0, view), 0);
  vec4 column1 = texelFetch(views, ivec2(1, view), 0);
  vec4 column2 = texelFetch(views, ivec2(2, view), 0);
  vec3 shift = vec3(column0.w, column1.w, column2.w);
  vec3 q = column0.xyz * sample_point.x + column1.xyz * sample_point.y + column2.xyz + sample_point.z * shift;
  float w = -q.z;
  // What lies at infinity is still in front of nothing at all.
  float disparity = max(sample_point.z, 1e-30);
  gl_Position = vec4(q.xy * inverse_tangents, depth.x * disparity / side - depth.y * w, w);
  texture_place = vec3(place.xy * texels_to_unit, place.z);
}
)";

constexpr const char* kFragment = R"(#version 300 es
precision highp float;
precision highp sampler2DArray;
centroid in vec3 texture_place;
uniform sampler2DArray colours;  // alpha of level 0: pack_cuts()
layout(location = 0) out vec4 colour;

int cuts_at(ivec2 texel, ivec2 last) {
  return int(texelFetch(colours, ivec3(min(texel, last), int(texture_place.z + 0.5)), 0).a * 255.0 + 0.5);
}
// From eighths, 0 for none, to the place of the cut between two texels, below 0 for none.
float cut_of(int code) { return code == 0 ? -1.0 : (float(code) - 0.5) / 8.0; }

// Between four texels with cuts between them, the place moves until only texels of its own surface are mixed. Surfaces
// end on the line from cut to cut, as in the mesh.
vec2 on_own_side(vec2 at, float top, float bottom, float left, float right) {
  bool is_corner = (top < 0.0) != (bottom < 0.0) && (left < 0.0) != (right < 0.0);
  if (!is_corner) {
    float x = top < 0.0 ? bottom : bottom < 0.0 ? top : mix(top, bottom, at.y);
    float y = left < 0.0 ? right : right < 0.0 ? left : mix(left, right, at.x);
    return vec2(x < 0.0 ? at.x : at.x < x ? 0.0 : 1.0, y < 0.0 ? at.y : at.y < y ? 0.0 : 1.0);
  }
  // One texel against the other three, as seen from that corner.
  vec2 corner = vec2(left < 0.0 ? 1.0 : 0.0, top < 0.0 ? 1.0 : 0.0);
  vec2 cut = abs(vec2(max(top, bottom), max(left, right)) - corner), from = abs(at - corner);
  if (from.x * cut.y + from.y * cut.x < cut.x * cut.y) return corner;
  return from.x > from.y ? vec2(1.0 - corner.x, at.y) : vec2(at.x, 1.0 - corner.y);
}

void main() {
  vec4 mixed = texture(colours, texture_place);
  // Filtered as well, alpha is 0 just where none of the mixed texels ends. A loop, because only those are left out
  // where all of them are done, on machines without a GPU.
  bool is_near_cut = mixed.a > 0.0;
  while (is_near_cut) {
    vec2 size = vec2(textureSize(colours, 0).xy);
    vec2 place = max(texture_place.xy * size - 0.5, 0.0);
    ivec2 texel = ivec2(place), last = ivec2(size) - 1;
    int here = cuts_at(texel, last);
    int bottom = cuts_at(texel + ivec2(0, 1), last) & 15, right = cuts_at(texel + ivec2(1, 0), last) >> 4;
    vec2 at = on_own_side(place - vec2(texel), cut_of(here & 15), cut_of(bottom), cut_of(here >> 4), cut_of(right));
    mixed = textureLod(colours, vec3((vec2(texel) + at + 0.5) / size, texture_place.z), 0.0);
    is_near_cut = false;
  }
  colour = vec4(mixed.rgb, 254.0 / 255.0);
}
)";

}  // namespace

struct ImpostorRenderer::State {
  State(const GlAbilities& a, const ImpostorOptions& options, Program p)
      : abilities(a), store(a, options.budget_bytes), program(std::move(p)) {
    program.use();
    glUniform1i(program.uniform("views"), 0);
    glUniform1i(program.uniform("colours"), 1);
    inverse_tangents = program.uniform("inverse_tangents");
    texels_to_unit = program.uniform("texels_to_unit");
    depth = program.uniform("depth");
    side = program.uniform("side");
  }

  GlAbilities abilities;
  ImpostorStore store;
  Program program;
  int inverse_tangents = -1, texels_to_unit = -1, depth = -1, side = -1;
  std::vector<const ResidentTile*> visible;
  std::vector<GLsizei> counts;
  std::vector<const void*> offsets;

  void draw_run(std::span<const ResidentTile* const> run);
};

// All tiles of a run share page and cell level.
void ImpostorRenderer::State::draw_run(std::span<const ResidentTile* const> run) {
  const ImpostorPage& page = *run.front()->page;
  glBindVertexArray(page.vertex_array());
  glBindTexture(GL_TEXTURE_2D_ARRAY, page.texture());
  glUniform2f(texels_to_unit, 1.0f / (16.0f * static_cast<float>(page.shape().width)),
              1.0f / (16.0f * static_cast<float>(page.shape().height)));
  glUniform1f(side, static_cast<float>(run.front()->side_m * (run.front()->is_delta ? 1 - kDeltaPreference : 1)));
  const std::size_t index_bytes = page.index_bytes();
  const GLenum index_type = index_bytes == 2 ? GL_UNSIGNED_SHORT : GL_UNSIGNED_INT;
  counts.clear(), offsets.clear();
  for (const ResidentTile* tile : run) {
    const std::size_t offset = tile->place.first_index * index_bytes;
    if (!counts.empty() && reinterpret_cast<std::size_t>(offsets.back()) +
                                   static_cast<std::size_t>(counts.back()) * index_bytes ==
                               offset) {
      counts.back() += static_cast<GLsizei>(tile->place.index_count);
      continue;
    }
    counts.push_back(static_cast<GLsizei>(tile->place.index_count));
    offsets.push_back(reinterpret_cast<const void*>(offset));
  }
  const auto draws = static_cast<GLsizei>(counts.size());
  if (!abilities.has_multi_draw) {
    for (GLsizei i = 0; i < draws; ++i) {
      glDrawElements(GL_TRIANGLES, counts[static_cast<std::size_t>(i)], index_type,
                     offsets[static_cast<std::size_t>(i)]);
    }
  } else if (abilities.is_embedded) {
    glMultiDrawElementsEXT(GL_TRIANGLES, counts.data(), index_type, offsets.data(), draws);
  } else {
    glMultiDrawElements(GL_TRIANGLES, counts.data(), index_type, offsets.data(), draws);
  }
}

ImpostorRenderer::ImpostorRenderer() = default;
ImpostorRenderer::~ImpostorRenderer() = default;

Result<std::unique_ptr<ImpostorRenderer>> ImpostorRenderer::create(const GlAbilities& abilities,
                                                                   const ImpostorOptions& options) {
  Result<Program> program = Program::build("impostor", kVertex, kFragment);
  if (!program) return tl::unexpected<Error>(program.error());
  std::unique_ptr<ImpostorRenderer> result(new ImpostorRenderer);
  result->state_ = std::make_unique<State>(abilities, options, std::move(*program));
  return result;
}

ImpostorRenderer::Upload ImpostorRenderer::upload(const LeafView& leaf, std::size_t frame_upload_bytes,
                                                  std::span<const std::shared_ptr<const LeafView>> in_use) {
  const UploadResult result = state_->store.upload(leaf, frame_upload_bytes, in_use);
  return {result.is_complete, result.uploaded_bytes, result.refused_tiles};
}

ImpostorStatistics ImpostorRenderer::draw(const LeafView& leaf, const ViewTransform& view) {
  State& s = *state_;
  ImpostorStatistics statistics;
  glActiveTexture(GL_TEXTURE0);
  s.store.views().update(view);

  s.visible.clear();
  for (const auto& tile : leaf.tiles) {
    if (!tile || tile->mesh.is_empty()) continue;
    const ResidentTile* resident = s.store.find(*tile);
    if (!resident) {
      ++statistics.missing_tiles;
      continue;
    }
    statistics.triangles_held += resident->place.index_count / 3;
    const ViewProjection& p = s.store.views().projection(resident->view);
    const glm::dvec3 middle = resident->middle, half = resident->half;
    const AffineBox box{p.face * glm::dvec3(middle.x, middle.y, 1.0) + middle.z * p.shift,
                        glm::dmat3(p.face[0] * half.x, p.face[1] * half.y, p.shift * half.z)};
    if (!view.may_see(box)) continue;
    statistics.triangles += resident->place.index_count / 3;
    s.visible.push_back(resident);
  }
  statistics.tiles_drawn = static_cast<std::uint32_t>(s.visible.size());
  // Near shells first: what they hide is rejected by depth before it is shaded.
  const auto order = [](const ResidentTile* t) {
    return std::tuple(t->level, t->is_delta, t->page, t->place.first_index);
  };
  std::sort(s.visible.begin(), s.visible.end(),
            [&](const ResidentTile* a, const ResidentTile* b) { return order(a) < order(b); });

  begin_scene_drawing(s.abilities);
  s.program.use();
  const DepthConvention depth = DepthConvention::of(s.abilities);
  glUniform2f(s.inverse_tangents, static_cast<float>(1 / view.tan_x), static_cast<float>(1 / view.tan_y));
  glUniform2f(s.depth, static_cast<float>(depth.scale * view.near_plane_m), depth.bias);
  glBindTexture(GL_TEXTURE_2D, s.store.views().texture());
  glActiveTexture(GL_TEXTURE1);
  for (std::size_t begin = 0; begin < s.visible.size();) {
    std::size_t end = begin;
    const auto same_run = [&](const ResidentTile* t) {
      const ResidentTile* first = s.visible[begin];
      return t->page == first->page && t->level == first->level && t->is_delta == first->is_delta;
    };
    while (end < s.visible.size() && same_run(s.visible[end])) ++end;
    s.draw_run(std::span(s.visible).subspan(begin, end - begin));
    ++statistics.draw_calls;
    begin = end;
  }
  glActiveTexture(GL_TEXTURE0);
  glBindVertexArray(0);
  s.store.evict();
  return statistics;
}

std::size_t ImpostorRenderer::held_bytes() const {
  return state_->store.held_bytes();
}

}  // namespace farfield::client
