// SPDX-License-Identifier: Apache-2.0
// Statues and clipped hedges as distance fields.
#pragma once

#include <cstdint>
#include <vector>

#include "server/model/implicit_surface.h"

namespace farfield {

struct ModelledShape {
  const char* name;
  DistanceField field;  // metres, standing on y = 0, facing +z
  Box bounds;
};

/// One of each kind: draped figure, athlete, bust, horse, seated thinker, knot. `seed` varies proportions and grain.
std::vector<ModelledShape> statue_shapes(std::uint64_t seed);
/// A hedge of `length_m` along x, 0.7 m wide and 1.1 m high, centred on the origin.
ModelledShape hedge_shape(float length_m, std::uint64_t seed);

}  // namespace farfield
