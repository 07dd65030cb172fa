// SPDX-License-Identifier: Apache-2.0
// Closed smooth meshes from a signed distance field: how the generated statues get their scanned look.
//
// Based on: Gibson 1998, "Constrained Elastic SurfaceNets"; the vertex of a cell is the mean of its edge crossings.
// Differs: no relaxation; vertices are pulled onto the surface by one Newton step, normals are the field's gradient.
#pragma once

#include <functional>
#include <glm/glm.hpp>

#include "server/model/model.h"

namespace farfield {

/// Negative inside; must not grow faster than distance (gradient length at most about 1), so that empty blocks of the
/// grid can be skipped.
using DistanceField = std::function<float(const glm::vec3&)>;

/// Meshes the zero level inside `bounds` on a grid of `cell_m`; positions, normals and indices are filled.
/// Requires: the surface keeps at least one cell away from the bounds.
Mesh mesh_of_field(const DistanceField& field, const Box& bounds, float cell_m);

/// The same at about `triangles` triangles (within some 10 %).
Mesh mesh_of_field(const DistanceField& field, const Box& bounds, std::size_t triangles);

}  // namespace farfield
