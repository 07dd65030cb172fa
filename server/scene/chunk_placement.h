// SPDX-License-Identifier: Apache-2.0
// From stored meshes and parts to the scene's list of placed chunks, with exact bounds and normal cones.
#pragma once

#include <span>
#include <vector>

#include "server/scene/scene.h"
#include "server/scene/stored_mesh.h"

namespace farfield {

struct PlacedChunks {
  std::vector<SceneChunk> chunks;            // part by part, in the order of the part's mesh
  std::vector<std::uint32_t> first_of_part;  // index of each part's first chunk
  std::vector<std::uint32_t> first_of_mesh;  // stored-chunk number of each mesh's first chunk
};

/// Also fills `parts[i].bounds`. Every placement is measured triangle by triangle, so cones and bounds hold for any
/// transform, mirrored and sheared ones too. Parallel over TBB.
PlacedChunks place_chunks(std::span<const StoredMesh> meshes, std::span<ScenePart> parts);

}  // namespace farfield
