// SPDX-License-Identifier: Apache-2.0
// The inner loop of building a scene: turns one cluster of source triangles into one chunk of a stored mesh.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "server/scene/chunking.h"
#include "server/scene/stored_mesh.h"

namespace farfield {

/// All triangles of a plan's sources under one running number.
class TriangleSources {
 public:
  explicit TriangleSources(std::span<const MeshSource> sources);
  std::size_t triangle_count() const { return first_.back(); }

  /// Remembers the source of the last triangle asked for. One per thread.
  class Cursor {
   public:
    explicit Cursor(const TriangleSources& sources) : sources_(&sources) {}
    /// Makes source() and vertices() those of triangle `id`.
    void seek(std::size_t id);
    const MeshSource& source() const { return sources_->sources_[at_]; }
    std::size_t source_index() const { return at_; }
    const std::uint32_t* vertices() const { return vertices_; }
    /// Positions in the stored mesh's frame, before snapping. Returns: false if one is not finite.
    bool corners(std::size_t id, glm::dvec3 out[3]);

   private:
    const TriangleSources* sources_;
    std::size_t at_ = 0;
    const std::uint32_t* vertices_ = nullptr;
  };
  Cursor cursor() const { return Cursor(*this); }

 private:
  std::span<const MeshSource> sources_;
  std::vector<std::size_t> first_;  // one more than there are sources
};

class ChunkEmitter {
 public:
  ChunkEmitter(const StoredMeshPlan& plan, const TriangleSources& sources, ContentHash texture, StoredMesh& out);
  /// Appends one chunk, or nothing if no triangle of the cluster has area on the position grid.
  /// Requires: at most kMaxChunkTriangles items.
  void emit(std::span<const TriangleItem> cluster);

 private:
  // A vertex in the codes it is stored in: equal codes are one vertex.
  struct Corner {
    std::int32_t grid[3];
    glm::i16vec2 normal;
    glm::u8vec4 colour;
    glm::vec2 uv;
  };
  static_assert(sizeof(Corner) == 28, "hashed as bytes: no padding allowed");

  bool add_triangle(const TriangleItem& item);
  glm::i16vec2 normal_code(const glm::dvec3& normal, const glm::dvec3& face_normal) const;
  glm::u8vec4 colour_code(std::uint32_t vertex);
  void snap_uvs();
  std::uint32_t find_or_add(const Corner& corner, std::uint32_t first_vertex);
  void store(StoredChunk& chunk);

  const StoredMeshPlan& plan_;
  TriangleSources::Cursor cursor_;
  ContentHash texture_;
  StoredMesh& out_;
  std::size_t normal_source_ = static_cast<std::size_t>(-1);  // the source normal_from_mesh_ belongs to
  glm::dmat3 normal_from_mesh_{1};
  std::vector<Corner> corners_;  // three per triangle
  std::vector<Corner> unique_;
  std::array<std::uint16_t, 2048> table_{};  // open addressing: index into unique_ plus one
};

}  // namespace farfield
