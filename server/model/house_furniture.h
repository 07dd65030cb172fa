// SPDX-License-Identifier: Apache-2.0
// Walls with openings, and the furniture of the generated house. Frames: y up, standing on y = 0, metres; furniture
// that leans on a wall has it behind, at z = 0, and reaches into the room along +z.
#pragma once

#include <span>
#include <vector>

#include "server/model/model_builder.h"
#include "server/model/random_stream.h"
#include "server/model/shapes.h"

namespace farfield {

struct HousePaints {
  Paint plain, plaster, concrete, brick, wood, dark_wood, parquet, tiles, fabric, grass, leaves;
  std::vector<Paint> wallpapers, carpets;
  Paint coloured(const glm::u8vec4& colour) const { return {plain.material, colour, 0}; }
};

/// A rectangular hole in a wall: along the wall, then up.
struct Opening {
  float left_m, right_m, bottom_m, top_m;
};

/// A wall along local x from 0 to `length_m`, between z = 0 (`back`) and z = thickness (`front`). Openings must not
/// overlap and come in order.
void add_wall(ModelBuilder& builder, const Paint& front, const Paint& back, const Paint& reveal, const Frame& frame,
              float length_m, float height_m, float thickness_m, std::span<const Opening> openings);
/// Frame and, folded back against the wall on the +z side, the leaf of a door in an opening that starts at x = 0.
void add_door(ModelBuilder& builder, const HousePaints& paints, const Frame& frame, const Opening& opening, float thickness_m);
void add_window(ModelBuilder& builder, const HousePaints& paints, const Frame& frame, const Opening& opening, float thickness_m);

void add_table(ModelBuilder& builder, const Paint& wood, const Frame& frame, glm::vec3 size_m);
void add_chair(ModelBuilder& builder, const Paint& wood, const Paint& seat, const Frame& frame);
void add_bookshelf(ModelBuilder& builder, const HousePaints& paints, const Frame& frame, float width_m, RandomStream& random);
void add_sofa(ModelBuilder& builder, const Paint& cloth, const Frame& frame, float width_m);
void add_bed(ModelBuilder& builder, const HousePaints& paints, const Frame& frame, RandomStream& random);
void add_wardrobe(ModelBuilder& builder, const HousePaints& paints, const Frame& frame, float width_m);
void add_kitchen(ModelBuilder& builder, const HousePaints& paints, const Frame& frame, float width_m);
void add_desk(ModelBuilder& builder, const HousePaints& paints, const Frame& frame);
void add_floor_lamp(ModelBuilder& builder, const HousePaints& paints, const Frame& frame);
void add_ceiling_lamp(ModelBuilder& builder, const HousePaints& paints, const Frame& frame);  // hangs from y = 0
void add_radiator(ModelBuilder& builder, const HousePaints& paints, const Frame& frame, float width_m);
void add_curtain(ModelBuilder& builder, const Paint& cloth, const Frame& frame, float width_m, float height_m);
void add_picture(ModelBuilder& builder, const HousePaints& paints, const Frame& frame, RandomStream& random);
void add_pot_plant(ModelBuilder& builder, const HousePaints& paints, const Frame& frame, RandomStream& random);

}  // namespace farfield
