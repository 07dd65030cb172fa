// SPDX-License-Identifier: Apache-2.0
// Planar polygons in space, concave and with holes, to triangles.
//
// Based on: Meisters 1975 ("Polygons have ears"); Eberly 1998, "Triangulation by Ear Clipping" (holes by bridges).
// Differs: polygons that are not simple never fail; where no ear is left the most convex corner is cut.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

namespace farfield {

/// Appends triangles, as indices into `points`, to `triangles`. The polygon is projected along its Newell normal;
/// triangles keep its winding. Fewer than three points, or a polygon without area: nothing is appended, except that a
/// single triangle is always passed on. Cost: O(n · reflex corners).
void triangulate_polygon(std::span<const glm::dvec3> points, std::vector<std::uint32_t>& triangles);

/// The same with holes: `rings` index into `points`, the first is the outer ring; rings need no particular winding
/// and repeat no point at their end.
void triangulate_polygon_with_holes(std::span<const glm::dvec3> points,
                                    std::span<const std::vector<std::uint32_t>> rings,
                                    std::vector<std::uint32_t>& triangles);

}  // namespace farfield
