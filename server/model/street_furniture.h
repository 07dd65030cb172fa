// SPDX-License-Identifier: Apache-2.0
// What stands in streets and parks: trees, cars, lamps, benches. Frames: y up, standing on y = 0.
#pragma once

#include "server/model/model_builder.h"
#include "server/model/random_stream.h"
#include "server/model/shapes.h"

namespace farfield {

/// Trunk and branches in `bark`, a crown of alpha-masked cards in `leaves`.
void add_tree(ModelBuilder& builder, const Paint& bark, const Paint& leaves, const Frame& frame, float height_m,
              RandomStream& random);
/// About 4.3 m long, along local x. `plain` is an untextured material.
void add_car(ModelBuilder& builder, const Paint& plain, const Frame& frame, RandomStream& random);
/// Its arm reaches along local x.
void add_street_lamp(ModelBuilder& builder, const Paint& plain, const Frame& frame);
/// 1.8 m long, along local x.
void add_bench(ModelBuilder& builder, const Paint& plain, const Frame& frame);

}  // namespace farfield
