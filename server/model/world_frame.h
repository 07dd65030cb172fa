// SPDX-License-Identifier: Apache-2.0
// From a file's units and axes to the world: metres, +Y up, shifted where --shift says.
#pragma once

#include <glm/glm.hpp>
#include <string_view>

#include "common/base/result.h"

namespace farfield {

/// world = shift + metres_per_unit · (axes turned so that `up` becomes +Y) · file. Right-handed axes stay so:
/// "y" keeps them; "z" gives (x, z, −y); "x" gives (−y, x, z).
/// Errors: kInvalidArgument (another up axis, units that are not positive and finite, a shift that is not finite).
Result<glm::dmat4> world_from_file(double metres_per_unit, std::string_view up, const glm::dvec3& shift);

}  // namespace farfield
