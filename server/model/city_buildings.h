// SPDX-License-Identifier: Apache-2.0
// Buildings of the generated city: façades by texture, everything that stands out of them by triangles.
#pragma once

#include <vector>

#include "server/model/model_builder.h"
#include "server/model/random_stream.h"
#include "server/model/shapes.h"

namespace farfield {

struct CityPaints {
  Paint plain;                 // coloured per object
  Paint asphalt, paving, grass, gravel, roof_tiles, shop_fronts, bark;
  std::vector<Paint> facades;  // textures of 4 × 4 windows
  std::vector<Paint> leaves;   // alpha-masked cards
  Paint coloured(const glm::u8vec4& colour) const { return {plain.material, colour, 0}; }
};

/// One house on a lot: [0, size.x] × [0, size.z] in the frame, its front at z = size.z, standing on y = 0.
void add_building(ModelBuilder& builder, const CityPaints& paints, const Frame& frame, glm::vec2 size_m, int floors,
                  RandomStream& random);

}  // namespace farfield
