// SPDX-License-Identifier: Apache-2.0
// Cuts near geometry at the border of the near region, once per leaf set: no fragment has to be tested or dropped.
#pragma once

#include <cstddef>

#include "client/near/surface_vertex.h"

namespace farfield::client {

/// Replaces the triangles from indices[first_index] on by what of them lies in the half-open box [min, max), as
/// Box::contains: a surface in the plane of a lower face stays, in that of an upper face it goes. Attributes are
/// interpolated, as a rasteriser would; new vertices are appended. Triangles that share an edge get the same points on
/// it, whichever way round either of them names it: no crack opens. O(triangles).
void clip_surface(const SurfaceBounds& box, std::size_t first_index, std::vector<SurfaceVertex>& vertices,
                  std::vector<std::uint32_t>& indices);

}  // namespace farfield::client
