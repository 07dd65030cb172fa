// SPDX-License-Identifier: Apache-2.0
#include "server/model/world_frame.h"

#include <cmath>

namespace farfield {

Result<glm::dmat4> world_from_file(double metres_per_unit, std::string_view up, const glm::dvec3& shift) {
  if (!(metres_per_unit > 0) || !std::isfinite(metres_per_unit)) {
    return fail(ErrorCode::kInvalidArgument, "--units {}: metres per unit must be a positive number", metres_per_unit);
  }
  if (!std::isfinite(shift.x) || !std::isfinite(shift.y) || !std::isfinite(shift.z)) {
    return fail(ErrorCode::kInvalidArgument, "--shift: three finite numbers are needed");
  }
  glm::dmat3 axes(1);  // columns: where the file's x, y and z axes point in the world
  if (up == "z") {
    axes = glm::dmat3(glm::dvec3(1, 0, 0), glm::dvec3(0, 0, -1), glm::dvec3(0, 1, 0));
  } else if (up == "x") {
    axes = glm::dmat3(glm::dvec3(0, 1, 0), glm::dvec3(-1, 0, 0), glm::dvec3(0, 0, 1));
  } else if (up != "y") {
    return fail(ErrorCode::kInvalidArgument, "--up {}: must be x, y or z", up);
  }
  glm::dmat4 world(metres_per_unit * axes);
  world[3] = glm::dvec4(shift, 1);
  return world;
}

}  // namespace farfield
