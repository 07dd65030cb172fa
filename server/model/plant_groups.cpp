// SPDX-License-Identifier: Apache-2.0
#include "server/model/plant_groups.h"

#include <array>

namespace farfield {
namespace {

constexpr glm::u8vec4 kStructure{92, 112, 132, 255}, kWall{232, 226, 206, 255}, kDoor{66, 98, 120, 255};
constexpr float kWallHalf = 0.075f;

void add_pumps(ModelBuilder& b, const PlantPaints& paints, const Frame& frame, RandomStream& random) {
  for (const float x : {1.6f, 6.4f}) {
    b.try_add([&] { add_pump(b, paints, frame.moved({x, 0, 2.2f}), random); });
  }
  b.try_add([&] {  // the header they deliver into
    add_pipe_route(b, paints.coloured(pipe_colour(random)), {frame.point({0, 3.15f, 2.45f}), frame.point({kStripLength, 3.15f, 2.45f})}, 0.14f, true);
  });
}

void add_vessels(ModelBuilder& b, const PlantPaints& paints, const Frame& frame, RandomStream& random) {
  for (const float x : {2.0f, 5.8f, 9.6f}) {
    b.try_add([&] { add_vertical_vessel(b, paints, frame.moved({x, 0, 2.3f}), random.between(0.9f, 1.5f), random.between(3.2f, 4.3f), random); });
  }
}

void add_switch_room(ModelBuilder& b, const PlantPaints& paints, const Frame& frame, RandomStream& random) {
  constexpr float kQuarterTurn = 1.57079632679f;
  b.try_add([&] {
    add_partition(b, paints, frame, kStripLength, kStripHeight);
    add_partition(b, paints, frame.moved({0, 0, kStripWidth}), kStripLength, kStripHeight, random.between(2.0f, 8.0f));
    for (const float x : {kWallHalf, kStripLength - kWallHalf}) {
      add_partition(b, paints, frame.moved({x, 0, kStripWidth}, kQuarterTurn), kStripWidth, kStripHeight);
    }
  });
  for (int k = 0; k < 10; ++k) {
    b.try_add([&] { add_cabinet(b, paints, frame.moved({1.2f + 0.82f * static_cast<float>(k), 0, 0.7f}), random); });
  }
}

void add_manifold(ModelBuilder& b, const PlantPaints& paints, const Frame& frame, RandomStream& random) {
  for (int k = 0; k < 4; ++k) {
    b.try_add([&] {
      const glm::vec3 at{1.6f + 2.6f * static_cast<float>(k), 0.8f, 1.2f};
      add_pipe_route(b, paints.coloured(pipe_colour(random)),
                     {frame.point(at), frame.point(at + glm::vec3(0, 0, 1.8f)), frame.point(at + glm::vec3(0, 3.6f, 1.8f))}, 0.09f, true);
      add_valve(b, paints, frame.point(at + glm::vec3(0, 0, 0.8f)), frame.axes[2], 0.09f);
    });
  }
  b.try_add([&] {
    add_pipe_route(b, paints.coloured(pipe_colour(random)), {frame.point({0.4f, 0.8f, 1.2f}), frame.point({kStripLength - 0.4f, 0.8f, 1.2f})}, 0.22f, true);
  });
}

// Long straight pipes above one another on trestles.
void add_pipe_bank(ModelBuilder& b, const PlantPaints& paints, const Frame& frame, RandomStream& random) {
  for (const float z : {0.9f, 1.9f, 2.9f}) {
    for (const float y : {0.5f, 1.5f, 2.5f}) {
      const float radius = random.between(0.06f, 0.32f);
      const Paint paint = paints.coloured(pipe_colour(random));
      const bool has_flanges = random.chance(0.5);
      b.try_add([&] { add_pipe_route(b, paint, {frame.point({0, y + radius, z}), frame.point({kStripLength, y + radius, z})}, radius, has_flanges); });
    }
  }
  for (const float x : {1.0f, 4.2f, 7.4f, 10.6f}) {
    b.try_add([&] {
      const Paint steel = paints.coloured(kStructure);
      for (const float z : {0.45f, 3.35f}) add_box(b, steel, frame, {x - 0.07f, 0, z - 0.07f}, {x + 0.07f, 3.2f, z + 0.07f}, kAllFaces & ~kFaceBottom);
      for (const float y : {0.5f, 1.5f, 2.5f}) add_box(b, steel, frame, {x - 0.05f, y - 0.14f, 0.5f}, {x + 0.05f, y, 3.3f}, kAllFaces & ~(kFaceFront | kFaceBack));
    });
  }
}

void add_ducts(ModelBuilder& b, const PlantPaints& paints, const Frame& frame, RandomStream& random) {
  for (const float z : {1.2f, 3.2f}) {
    b.try_add([&] { add_duct(b, paints, frame.moved({0, 3.2f, z}), kStripLength, {1.2f, 0.8f}); });
  }
  b.try_add([&] { add_drum(b, paints, frame.moved({5.8f, 0, 2.0f}), 0.75f, 7.0f, random); });
}

// A turbine with its generator on one foundation.
void add_turbine(ModelBuilder& b, const PlantPaints& paints, const Frame& frame, RandomStream& random) {
  const Paint casing = paints.coloured(random.chance(0.5) ? glm::u8vec4(96, 132, 120, 255) : glm::u8vec4(176, 170, 150, 255));
  const Paint generator = paints.coloured({70, 92, 128, 255});
  const glm::mat3 along_x = frame.axes * glm::mat3(glm::vec3(0, -1, 0), glm::vec3(1, 0, 0), glm::vec3(0, 0, 1));
  const Frame shaft{frame.point({0, 2.2f, 2.3f}), along_x};
  b.try_add([&] {
    add_box(b, paints.concrete, frame, {0.3f, 0, 0.7f}, {kStripLength - 0.3f, 0.9f, 3.9f}, kAllFaces & ~kFaceBottom);
    const std::array<glm::vec2, 14> profile{{{0, 0.7f}, {0.5f, 0.75f}, {0.55f, 1.5f}, {0.9f, 1.7f}, {1.0f, 2.6f}, {0.75f, 2.9f}, {0.75f, 3.2f},
                                             {1.0f, 3.5f}, {1.35f, 4.3f}, {1.4f, 4.5f}, {1.4f, 5.2f}, {1.3f, 5.4f}, {0.4f, 5.7f}, {0.3f, 6.6f}}};
    add_lathe(b, casing, shaft, profile, 28);
  });
  b.try_add([&] {
    const std::array<glm::vec2, 8> profile{{{0.3f, 6.5f}, {0.95f, 6.55f}, {1.1f, 6.7f}, {1.1f, 9.9f}, {0.95f, 10.1f}, {0.45f, 10.15f}, {0.45f, 10.9f}, {0, 11.0f}}};
    add_lathe(b, generator, shaft, profile, 28);
    for (const float x : {0.9f, 3.0f, 6.1f}) add_box(b, casing, frame, {x, 0.9f, 1.6f}, {x + 0.3f, 2.0f, 3.0f}, kAllFaces & ~kFaceBottom);
    add_box(b, generator, frame, {6.8f, 0.9f, 1.3f}, {9.8f, 1.9f, 3.3f}, kAllFaces & ~kFaceBottom);
  });
  for (const float x : {2.2f, 4.8f}) {  // steam in, from above
    b.try_add([&] { add_pipe_route(b, paints.coloured({206, 210, 212, 255}), {frame.point({x, 3.0f, 2.3f}), frame.point({x, kStripHeight, 2.3f})}, 0.26f, true); });
  }
}

}  // namespace

void add_partition(ModelBuilder& builder, const PlantPaints& paints, const Frame& frame, float length_m,
                   float height_m, float door_x_m) {
  constexpr float kDoorWidth = 1.6f, kDoorHeight = 2.4f;
  const Paint wall{paints.concrete.material, kWall, paints.concrete.repeats_per_m};
  const auto piece = [&](float x0, float x1, float y0) {
    add_box(builder, wall, frame, {x0, y0, -kWallHalf}, {x1, height_m, kWallHalf}, y0 > 0 ? kAllFaces : kAllFaces & ~kFaceBottom);
  };
  if (door_x_m < 0) {
    piece(0, length_m, 0);
    return;
  }
  piece(0, door_x_m, 0);
  piece(door_x_m, door_x_m + kDoorWidth, kDoorHeight);
  piece(door_x_m + kDoorWidth, length_m, 0);
}

void add_closed_door(ModelBuilder& builder, const PlantPaints& paints, const Frame& frame) {
  for (const float x : {-0.9f, 0.02f}) {
    add_box(builder, paints.coloured(kDoor), frame, {x, 0.02f, -kWallHalf - 0.03f}, {x + 0.88f, 2.3f, kWallHalf + 0.03f});
  }
}

void add_machine_strip(ModelBuilder& builder, const PlantPaints& paints, const Frame& frame, RandomStream& random) {
  switch (random.below(10)) {
    case 0: return add_pumps(builder, paints, frame, random);
    case 1: return add_vessels(builder, paints, frame, random);
    case 2: return add_switch_room(builder, paints, frame, random);
    case 3: return add_manifold(builder, paints, frame, random);
    case 4: case 5: return add_pipe_bank(builder, paints, frame, random);
    case 6: return add_ducts(builder, paints, frame, random);
    case 7: return add_turbine(builder, paints, frame, random);
    case 8:
      for (const float z : {1.2f, 3.3f}) {
        builder.try_add([&] { add_exchanger(builder, paints, frame.moved({5.8f, 0, z}), 7.6f, random); });
      }
      return;
    default:
      builder.try_add([&] { add_drum(builder, paints, frame.moved({5.8f, 0, 2.2f}), 1.25f, 8.4f, random); });
  }
}

}  // namespace farfield
