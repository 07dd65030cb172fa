// SPDX-License-Identifier: Apache-2.0
// The ray-tracing structure over stored meshes and their placements. Embree stays behind this header.
#pragma once

#include <memory>
#include <span>

#include "common/base/result.h"
#include "server/scene/ray_packet.h"
#include "server/scene/scene.h"
#include "server/scene/stored_mesh.h"
#include "server/scene/texture_set.h"

namespace farfield {

/// Refers to the meshes and textures it was built over: they must outlive it and must not move.
/// Queries are safe from any thread.
class RayScene {
 public:
  RayScene();
  ~RayScene();
  RayScene(RayScene&&) noexcept;
  RayScene& operator=(RayScene&&) noexcept;

  /// The first `flattened_parts` parts enter the top level directly, the others as instances. Builds on the TBB
  /// workers of the calling arena. Errors: kInternal (Embree's own words).
  static Result<RayScene> build(std::span<const StoredMesh> meshes, std::span<const ScenePart> parts,
                                std::size_t flattened_parts, const TextureSet& textures);

  void intersect(const RayPacket& rays, HitPacket& hits, bool coherent) const;
  std::uint32_t occluded(const RayPacket& rays) const;
  std::uint32_t occluded_coherent(const RayPacket& rays) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace farfield
