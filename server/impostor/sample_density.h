// SPDX-License-Identifier: Apache-2.0
// How closely a view samples a surface along its slant: tells a view that shows a surface from one that only grazes it.
#pragma once

#include <cmath>

#include <glm/glm.hpp>

namespace farfield {

/// Samples per metre of a view, along the direction of steepest slant, on a surface element with this normal; `to_point`: from
/// the view to it, metres. In units of 1/pitch and of the normal's length, since a sample spans r·pitch/cos there: compare views
/// by their ratio.
inline double slant_density(const glm::dvec3& normal, const glm::dvec3& to_point) {
  return std::abs(glm::dot(normal, to_point)) / glm::dot(to_point, to_point);
}

}  // namespace farfield
