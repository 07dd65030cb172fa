// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/baselines/geometry_lod.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <iostream>
#include <map>
#include <tuple>

#include "client/gl/framebuffer.h"
#include "client/near/surface_program.h"
#include "client/near/texture_cache.h"
#include "tests/bench/baselines/geometry.h"
#include "tests/bench/baselines/lod_forest.h"
#include "tests/bench/measure_frames.h"

namespace farfield::bench {
namespace {

constexpr std::size_t kBufferIndices = 3u << 20;  // a buffer is closed at a million triangles, as geometry's are

/// Chunks of one texture and mask, until they are uploaded.
struct PendingMesh {
  std::shared_ptr<const client::DecodedTexture> texture;
  bool is_alpha_masked = false;
  float alpha_cutoff = 0.5f;
  std::vector<client::SurfaceVertex> vertices;
  std::vector<std::uint32_t> indices, chunk_ends;
};

/// Uploaded; of the forest only the nodes are kept.
struct LodBuffer {
  std::shared_ptr<const client::DecodedTexture> texture;
  bool is_alpha_masked = false;
  float alpha_cutoff = 0.5f;
  LodForest forest;
  client::Buffer vertices, indices;
  client::VertexArrayName array;
};

using MaterialKey = std::tuple<ContentHash, bool, float>;
MaterialKey key_of(const Chunk& chunk) {
  return {chunk.texture, chunk.is_alpha_masked, chunk.alpha_cutoff};
}

/// In double: a vertex that two chunks share must come out the same, or it could not be merged.
glm::vec3 placed(const glm::dmat4x3& from_chunk, const ChunkVertex& vertex) {
  return glm::vec3(from_chunk * glm::dvec4(vertex.position, 1));
}

/// Positions that more than one buffer uses: no level of detail may move them.
class MeetingPoints {
 public:
  void add(const glm::vec3& position, std::uint32_t buffer) { uses_.push_back({hash_of(position), buffer}); }
  void finish() {
    std::sort(uses_.begin(), uses_.end());
    for (std::size_t i = 1; i < uses_.size(); ++i)
      if (uses_[i].first == uses_[i - 1].first && uses_[i].second != uses_[i - 1].second) shared_.push_back(uses_[i].first);
    uses_ = {};
  }
  bool contains(const glm::vec3& position) const { return std::binary_search(shared_.begin(), shared_.end(), hash_of(position)); }

 private:
  static ContentHash hash_of(const glm::vec3& p) { return hash_value(p); }
  std::vector<std::pair<ContentHash, std::uint32_t>> uses_;
  std::vector<ContentHash> shared_;  // sorted
};

MeetingPoints find_meeting_points(const Scene& scene, const glm::dvec3& origin) {
  MeetingPoints meeting;
  std::map<MaterialKey, std::pair<std::uint32_t, std::size_t>> open;  // the buffer a material fills, and its indices so far
  std::uint32_t buffers = 0;
  for (std::size_t i = 0; i < scene.chunks().size(); ++i) {
    const Chunk chunk = scene.chunk_geometry(static_cast<std::uint32_t>(i));
    const auto [at, is_new] = open.try_emplace(key_of(chunk), buffers, 0);
    buffers += is_new;
    glm::dmat4x3 from_chunk = scene.chunks()[i].scene_from_chunk;
    from_chunk[3] -= origin;
    for (const ChunkVertex& vertex : chunk.vertices) meeting.add(placed(from_chunk, vertex), at->second.first);
    at->second.second += chunk.indices.size();
    if (at->second.second >= kBufferIndices) open.erase(at);
  }
  meeting.finish();
  return meeting;
}

class LodRenderer {
 public:
  static Result<LodRenderer> create(const client::GlAbilities& abilities, const Scene& scene) {
    Result<client::SurfacePrograms> programs = client::SurfacePrograms::build();
    if (!programs) return tl::unexpected(programs.error());
    LodRenderer renderer(abilities, scene.bounds().center(), std::move(*programs));
    renderer.add(scene);
    return renderer;
  }

  /// Returns: triangles drawn.
  std::uint64_t draw(const client::ViewTransform& view, double error_per_metre) {
    std::uint64_t triangles = 0;
    textures_.begin_frame();
    client::begin_scene_drawing(abilities_);
    programs_.begin_frame(view, origin_, client::DepthConvention::of(abilities_));
    glActiveTexture(GL_TEXTURE0);
    for (const LodBuffer& buffer : buffers_) {
      collect(buffer, view, error_per_metre);
      if (runs_.empty()) continue;
      const client::GlName texture = buffer.texture ? textures_.use(*buffer.texture) : 0;
      glBindTexture(GL_TEXTURE_2D, texture);
      programs_.use({texture != 0, texture != 0 && buffer.is_alpha_masked}, buffer.alpha_cutoff);
      glBindVertexArray(buffer.array.name());
      triangles += draw_runs();
    }
    glBindVertexArray(0);
    textures_.end_frame();
    return triangles;
  }
  std::size_t triangles_held() const { return triangles_held_; }

 private:
  LodRenderer(const client::GlAbilities& abilities, const glm::dvec3& origin, client::SurfacePrograms programs)
      : abilities_(abilities),
        origin_(origin),
        programs_(std::move(programs)),
        textures_(std::numeric_limits<std::size_t>::max(), std::numeric_limits<std::size_t>::max(), abilities.max_texture_edge) {}

  void add(const Scene& scene) {
    const TexturesByHash textures = full_textures(scene);
    const MeetingPoints meeting = find_meeting_points(scene, origin_);
    std::map<MaterialKey, PendingMesh> pending;
    for (std::size_t i = 0; i < scene.chunks().size(); ++i) {
      const Chunk chunk = scene.chunk_geometry(static_cast<std::uint32_t>(i));
      PendingMesh& mesh = pending[key_of(chunk)];
      if (const auto found = textures.find(chunk.texture); found != textures.end()) mesh.texture = found->second;
      mesh.is_alpha_masked = chunk.is_alpha_masked, mesh.alpha_cutoff = chunk.alpha_cutoff;
      glm::dmat4x3 from_chunk = scene.chunks()[i].scene_from_chunk;
      from_chunk[3] -= origin_;
      const std::size_t first_vertex = mesh.vertices.size();
      client::append_surface(chunk, glm::mat4x3(from_chunk), mesh.vertices, mesh.indices);
      for (std::size_t v = 0; v < chunk.vertices.size(); ++v)
        mesh.vertices[first_vertex + v].position = placed(from_chunk, chunk.vertices[v]);
      mesh.chunk_ends.push_back(static_cast<std::uint32_t>(mesh.indices.size()));
      if (mesh.indices.size() >= kBufferIndices) upload(std::exchange(mesh, {}), meeting);
    }
    for (auto& [key, mesh] : pending)
      if (!mesh.indices.empty()) upload(std::move(mesh), meeting);
  }

  void upload(PendingMesh mesh, const MeetingPoints& meeting) {
    LodBuffer buffer{
        mesh.texture, mesh.is_alpha_masked, mesh.alpha_cutoff,
        build_lod_forest(mesh.vertices, mesh.indices, mesh.chunk_ends, [&](const glm::vec3& p) { return meeting.contains(p); })};
    const auto vertices = std::as_bytes(std::span(buffer.forest.vertices)), indices = std::as_bytes(std::span(buffer.forest.indices));
    buffer.vertices = client::Buffer::make(vertices.size());
    buffer.vertices.write(0, vertices);
    buffer.indices = client::Buffer::make(indices.size());
    buffer.indices.write(0, indices);
    buffer.array = client::make_surface_vertex_array(buffer.vertices, buffer.indices);
    triangles_held_ += buffer.forest.indices.size() / 3;
    buffer.forest.vertices = {}, buffer.forest.indices = {};
    buffers_.push_back(std::move(buffer));
  }

  void collect(const LodBuffer& buffer, const client::ViewTransform& view, double error_per_metre) {
    runs_.clear();
    const glm::dmat3& rotation = view.camera_from_scene;
    const glm::dvec3 eye = view.eye - origin_;
    const auto may_see = [&](const LodNode& node) {
      const glm::dvec3 low(node.min), high(node.max), half = 0.5 * (high - low);
      return view.may_see(
          {rotation * (0.5 * (low + high) - eye), glm::dmat3(rotation[0] * half.x, rotation[1] * half.y, rotation[2] * half.z)});
    };
    select_lods(buffer.forest, glm::vec3(eye), static_cast<float>(error_per_metre), may_see,
                [&](const LodNode& node) { runs_.emplace_back(node.first_index, node.index_count); });
    std::sort(runs_.begin(), runs_.end());
  }

  std::uint64_t draw_runs() {
    std::uint64_t triangles = 0;
    counts_.clear(), offsets_.clear();
    std::uint32_t end = std::numeric_limits<std::uint32_t>::max();
    for (const auto& [first, count] : runs_) {
      triangles += count / 3;
      if (first == end) {
        counts_.back() += static_cast<GLsizei>(count);
      } else {
        counts_.push_back(static_cast<GLsizei>(count));
        offsets_.push_back(reinterpret_cast<const void*>(first * sizeof(std::uint32_t)));
      }
      end = first + count;
    }
    const auto calls = static_cast<GLsizei>(counts_.size());
    if (abilities_.has_multi_draw && !abilities_.is_embedded) {
      glMultiDrawElements(GL_TRIANGLES, counts_.data(), GL_UNSIGNED_INT, offsets_.data(), calls);
    } else {
      for (std::size_t i = 0; i < counts_.size(); ++i) glDrawElements(GL_TRIANGLES, counts_[i], GL_UNSIGNED_INT, offsets_[i]);
    }
    return triangles;
  }

  client::GlAbilities abilities_;
  glm::dvec3 origin_;
  client::SurfacePrograms programs_;
  client::TextureCache textures_;
  std::vector<LodBuffer> buffers_;
  std::size_t triangles_held_ = 0;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> runs_;  // first index, count
  std::vector<GLsizei> counts_;
  std::vector<const void*> offsets_;
};

Result<MethodResult> run_geometry_lod(const World& world, const KnobValues& knobs) {
  auto context = client::GlContext::create_surfaceless();
  if (!context) return tl::unexpected(context.error());
  const client::GlAbilities& abilities = (*context)->abilities();
  const BenchClock::time_point start = BenchClock::now();
  Result<LodRenderer> renderer = LodRenderer::create(abilities, *world.scene);
  if (!renderer) return tl::unexpected(renderer.error());
  std::cerr << fmt::format("levels of detail: {} triangles made of {} in {:.1f} s\n", renderer->triangles_held(),
                           world.scene->statistics().drawn_triangles, 1e-3 * ms_since(start));
  const Display& display = world.options.display;
  auto target = client::Framebuffer::create(abilities, display.width, display.height, knobs.whole("samples"));
  if (!target) return tl::unexpected(target.error());
  std::vector<std::uint8_t> rgba(std::size_t{4} * display.width * display.height);
  const double error_per_metre = knobs["error_px"] * display.pixel_pitch();
  const auto draw = [&](const Pose& eye) -> Result<DrawnFrame> {
    const BenchClock::time_point begin = BenchClock::now();
    target->begin();
    DrawnFrame frame;
    frame.triangles = static_cast<double>(renderer->draw(client::ViewTransform::of(display, eye, kNearPlaneM), error_per_metre));
    target->resolve();
    glFinish();
    target->read_colour(rgba);
    frame.ms = ms_since(begin);
    frame.seen.rgb = over_background(*world.scene, rgba);
    return frame;
  };
  MethodResult result;
  if (Status status = measure_frames(world, draw, result); !status) return tl::unexpected(status.error());
  return result;
}

}  // namespace

Method geometry_lod_method() {
  return {"geometry-lod",
          "static levels of detail by screen error, through OpenGL",
          {{"error_px", 1, "error of a level at its nearest point, pixels", 0, 1000},
           {.name = "samples", .default_value = 1, .description = "multisamples per pixel", .choices = {1, 4}}},
          run_geometry_lod};
}

}  // namespace farfield::bench
