// SPDX-License-Identifier: Apache-2.0
// Which chunks of near geometry may be seen from a box of viewpoints.
//
// Based on: item buffers (Décoret et al. 1999, section 5.3) and the regional back-face test (Chuang 2002, section 4.1.2).
#pragma once

#include <vector>

#include "server/scene/scene.h"

namespace farfield {

/// A set of chunk indices with constant-time insertion, and the triangles it draws.
class ChunkSet {
 public:
  explicit ChunkSet(const Scene& scene) : scene_(&scene), is_member_(scene.chunks().size(), false) {}
  void insert(std::uint32_t chunk) {
    if (is_member_[chunk]) return;
    is_member_[chunk] = true;
    members_.push_back(chunk);
    triangles_ += scene_->chunks()[chunk].triangles;
  }
  bool contains(std::uint32_t chunk) const { return is_member_[chunk]; }
  const std::vector<std::uint32_t>& members() const { return members_; }
  std::size_t triangles() const { return triangles_; }

 private:
  const Scene* scene_;
  std::vector<bool> is_member_;
  std::vector<std::uint32_t> members_;
  std::size_t triangles_ = 0;
};

/// True if every triangle of the chunk faces away from every point of the box. Only for reports and counters: shading
/// is two-sided, so a closed solid's back faces are hidden by its front faces, but an open surface's are not.
bool faces_away(const SceneChunk& chunk, const Box& viewpoints);

/// Chunks near the box that an item buffer missed because they are thin or small: rays from the viewpoints straight to
/// points of their triangles. Inserts those that some ray reaches into `visible`; O(candidates · viewpoints) rays.
void add_thin_chunks(const Scene& scene, const std::vector<std::uint32_t>& candidates,
                     const std::vector<glm::dvec3>& viewpoints, ChunkSet& visible);

}  // namespace farfield
