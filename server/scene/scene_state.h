// SPDX-License-Identifier: Apache-2.0
// What a Scene holds: private to this folder.
#pragma once

#include <string>
#include <vector>

#include "server/scene/chunk_index.h"
#include "server/scene/chunk_placement.h"
#include "server/scene/encoded_cache.h"
#include "server/scene/pending_rays.h"
#include "server/scene/scene.h"
#include "server/scene/stored_mesh.h"
#include "server/scene/texture_set.h"

namespace farfield {

inline constexpr std::size_t kEncodedCacheBytes = std::size_t{128} << 20;

struct Scene::State {
  std::string name;
  glm::dvec3 origin{0};
  Box bounds;
  ContentHash hash = 0;
  SceneStatistics statistics;
  glm::u8vec3 background{0};

  TextureSet textures;
  std::vector<TextureInfo> texture_infos;
  std::vector<StoredMesh> meshes;  // complete before `rays` is built over them
  std::vector<ScenePart> parts;
  std::size_t flattened_parts = 0;         // parts before this one have the identity transform
  std::vector<glm::mat3> light_from_mesh;  // per part: inverse transpose up to a factor, for normals
  PlacedChunks placed;
  ChunkIndex index;
  std::vector<std::uint32_t> mesh_of_stored_chunk;
  mutable EncodedCache encoded{kEncodedCacheBytes};
  PendingRays rays;  // last: destroyed before what it points to

  /// Everything that follows from meshes, parts, textures and placed chunks alone, but for rays and the hash.
  void derive();

  ContentHash texture_hash(const StoredMesh& mesh) const {
    return mesh.surface.texture < 0 ? 0 : textures.hash(static_cast<std::uint32_t>(mesh.surface.texture));
  }
};

}  // namespace farfield
