// SPDX-License-Identifier: Apache-2.0
#include "server/model/house_rooms.h"

namespace farfield {
namespace {

constexpr float kQuarterTurn = 1.57079632679f;

struct Room {
  ModelBuilder& builder;
  const HousePaints& paints;
  const Frame& frame;
  RandomStream& random;

  Frame on_left(float z) const { return frame.moved({0, 0, z}, kQuarterTurn); }
  Frame on_right(float z) const { return frame.moved({kRoomWidth, 0, z}, -kQuarterTurn); }
};

// Adds one object if the budget allows it.
#define FARFIELD_PLACE(call) room.builder.try_add([&] { call; })

void furnish_bedroom(const Room& room) {
  FARFIELD_PLACE(add_bed(room.builder, room.paints, room.on_right(1.9f), room.random));
  FARFIELD_PLACE(add_wardrobe(room.builder, room.paints, room.on_left(1.3f), 1.7f));
}

void furnish_living_room(const Room& room) {
  Paint cloth = room.paints.fabric;
  cloth.colour = room.random.chance(0.5) ? glm::u8vec4(172, 92, 74, 255) : glm::u8vec4(96, 118, 128, 255);
  FARFIELD_PLACE(add_sofa(room.builder, cloth, room.on_right(1.9f), 2.1f));
  FARFIELD_PLACE(add_table(room.builder, room.paints.dark_wood, room.frame.moved({2.75f, 0, 1.9f}), {0.6f, 0.42f, 1.1f}));
  FARFIELD_PLACE(add_bookshelf(room.builder, room.paints, room.on_left(1.5f), 1.4f, room.random));
  FARFIELD_PLACE(add_floor_lamp(room.builder, room.paints, room.frame.moved({3.95f, 0, 0.5f})));
}

void furnish_office(const Room& room) {
  for (const float z : {1.1f, 2.75f}) {
    FARFIELD_PLACE(add_desk(room.builder, room.paints, room.on_right(z)));
    FARFIELD_PLACE(add_chair(room.builder, room.paints.dark_wood, room.paints.fabric, room.frame.moved({3.1f, 0, z}, kQuarterTurn)));
  }
  FARFIELD_PLACE(add_bookshelf(room.builder, room.paints, room.on_left(1.0f), 0.9f, room.random));
}

void furnish_kitchen(const Room& room) {
  FARFIELD_PLACE(add_kitchen(room.builder, room.paints, room.on_right(1.75f), 3.0f));
  const Frame table = room.frame.moved({2.45f, 0, 1.5f});
  FARFIELD_PLACE(add_table(room.builder, room.paints.wood, table, {0.75f, 0.75f, 1.3f}));
  for (const float side : {-1.0f, 1.0f}) {
    FARFIELD_PLACE(add_chair(room.builder, room.paints.wood, room.paints.fabric, table.moved({0, 0, 0.85f * side}, side > 0 ? 2 * kQuarterTurn : 0.0f)));
  }
}

void furnish_library(const Room& room) {
  for (const float z : {0.95f, 2.3f}) FARFIELD_PLACE(add_bookshelf(room.builder, room.paints, room.on_right(z), 1.25f, room.random));
  const Frame table = room.frame.moved({2.75f, 0, 1.6f});
  FARFIELD_PLACE(add_table(room.builder, room.paints.dark_wood, table, {0.9f, 0.76f, 1.5f}));
  for (const float side : {-1.0f, 1.0f}) {
    FARFIELD_PLACE(add_chair(room.builder, room.paints.dark_wood, room.paints.fabric, table.moved({0, 0, 0.95f * side}, side > 0 ? 2 * kQuarterTurn : 0.0f)));
  }
}

}  // namespace

void furnish_room(ModelBuilder& builder, const HousePaints& paints, const Frame& frame, RandomStream& random) {
  const Room room{builder, paints, frame, random};
  switch (random.below(6)) {
    case 0: case 1: furnish_bedroom(room); break;
    case 2: furnish_living_room(room); break;
    case 3: furnish_office(room); break;
    case 4: furnish_kitchen(room); break;
    default: furnish_library(room);
  }
  FARFIELD_PLACE(add_radiator(builder, paints, frame.moved({2.1f, 0, 0}), 1.3f));
  for (const float x : {1.0f, 3.2f}) {
    Paint cloth = paints.fabric;
    cloth.colour = {206, 186, 150, 255};
    FARFIELD_PLACE(add_curtain(builder, cloth, frame.moved({x, 0.1f, 0.12f}), 0.5f, 2.45f));
  }
  FARFIELD_PLACE(add_ceiling_lamp(builder, paints, frame.moved({2.2f, 2.8f, 2.2f})));
  FARFIELD_PLACE(add_picture(builder, paints, room.on_left(2.75f).moved({0, 1.6f, 0}), random));
  FARFIELD_PLACE(add_pot_plant(builder, paints, frame.moved({0.35f, 0, 0.35f}), random));
}

#undef FARFIELD_PLACE

}  // namespace farfield
