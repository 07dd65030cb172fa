// SPDX-License-Identifier: Apache-2.0
// The generators behind generate_model(), one per kind. Each fills the budget with whole modules in growth order.
#pragma once

#include <cstdint>

#include "server/model/model.h"
#include "server/model/model_builder.h"
#include "server/model/shapes.h"

namespace farfield {

Model generate_pipes(std::size_t triangles, std::uint64_t seed);
Model generate_city(std::size_t triangles, std::uint64_t seed);
Model generate_statues(std::size_t triangles, std::uint64_t seed);
Model generate_house(std::size_t triangles, std::uint64_t seed);

/// Spends what is left of the budget, once whole modules no longer fit, on small boxes standing on a strip of floor
/// `low` … `high` (module metres, low.y = high.y).
void fill_with_boxes(ModelBuilder& builder, const Paint& paint, const glm::vec3& low, const glm::vec3& high,
                     std::uint64_t seed);

}  // namespace farfield
