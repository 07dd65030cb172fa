// SPDX-License-Identifier: Apache-2.0
// How closely a view samples a surface along its slant: tells a view that shows a surface from one that only grazes it.
#pragma once

#include <cmath>

#include <glm/glm.hpp>

#include "common/impostor/settings.h"

namespace farfield {

/// Samples per metre of a view, along the direction of steepest slant, on a surface element with this normal; `to_point`: from
/// the view to it, metres. In units of 1/pitch and of the normal's length, since a sample spans r·pitch/cos there: compare views
/// by their ratio.
inline double slant_density(const glm::dvec3& normal, const glm::dvec3& to_point) {
  return std::abs(glm::dot(normal, to_point)) / glm::dot(to_point, to_point);
}

/// A view that sees a surface so obliquely that its samples stretch over more than this many of a delta view's does not stand in
/// for that one there: by slant_density(), as the intra view has more samples. At two, delta tiles take up to a twentieth more bytes
/// for a few hundredths of a decibel.
inline double largest_stretch(const ImpostorSettings& settings, std::uint8_t view) {
  return 3.0 * settings.edge_samples(view) / settings.edge_samples(1);
}

}  // namespace farfield
