// SPDX-License-Identifier: Apache-2.0
// What every model goes through after reading, whatever read it: nothing broken reaches the scene.
#pragma once

#include "common/base/result.h"
#include "server/model/model.h"

namespace farfield {

/// Drops triangles whose vertices are not finite or beyond kMaxCoordinate, whose indices point nowhere, or whose area
/// is zero in double over the stored floats; mends normals (unit length, the faces' where there is none) and texture
/// coordinates; drops vertices no triangle uses, meshes without triangles, and instances with a transform that is not
/// finite, is singular, or carries the mesh beyond kMaxCoordinate. Each kind of loss is counted in one warning.
/// Requires: mesh, material and texture numbers in range, per-vertex arrays empty or as long as positions.
void clean_model(Model& model);

/// Removes meshes without triangles and their instances.
void drop_empty_meshes(Model& model);

/// Removes materials no mesh has and textures no material has; materials that look the same become the first of them
/// (AC3D files bring one per surface group), so that triangles can be grouped by material.
void drop_unused_materials(Model& model);

/// Joins vertices whose every attribute is bit for bit the same. Readers of unindexed formats call this.
void weld_vertices(Mesh& mesh);

}  // namespace farfield
