// SPDX-License-Identifier: Apache-2.0
// The first step of building a scene: which meshes of the model are merged, which are instanced, and where each goes.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <glm/mat4x3.hpp>
#include <vector>

#include "common/base/result.h"
#include "server/model/model.h"
#include "server/scene/scene_frame.h"

namespace farfield {

/// What triangles must share to lie in one chunk. Base colours differ freely: they are carried by the vertices.
struct SurfaceState {
  int texture = -1;  // index into Model::textures
  bool is_alpha_masked = false;
  float alpha_cutoff = 0.5f;

  bool operator==(const SurfaceState&) const = default;
};

/// One mesh of the model on its way into a stored mesh.
struct MeshSource {
  const Mesh* mesh = nullptr;  // belongs to the model
  glm::u8vec4 base_colour{255};
  glm::dmat3 linear{1};  // stored position = linear · position + offset
  glm::dvec3 offset{0};
};

struct StoredMeshPlan {
  SurfaceState surface;
  double step = 1;  // position grid
  std::vector<MeshSource> sources;
};

struct PartPlan {
  std::uint32_t mesh = 0;  // index into ScenePlan::meshes
  glm::mat4x3 scene_from_mesh{1};
};

struct ScenePlan {
  SceneFrame frame;
  std::vector<StoredMeshPlan> meshes;
  std::vector<PartPlan> parts;
};

/// Meshes with more triangles than this that are placed at least twice are instanced: below, the cost of entering an
/// instance outweighs the memory it saves.
inline constexpr std::size_t kInstancedTriangles = 1000;

/// Checks the model and decides. The plan points into `model`, which must outlive it.
/// Errors: kBadData (an index or array size that does not fit; nothing to draw).
Result<ScenePlan> plan_scene(const Model& model);

}  // namespace farfield
