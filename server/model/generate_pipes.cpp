// SPDX-License-Identifier: Apache-2.0
// A power plant: square bays of 15 m over five floors, about 200 triangles per square metre of ground.
//
// In each bay the parts x < 3 m and z < 3 m are corridors on every floor, free up to 3 m; the pipes of the racks run
// above head height. Doors and walls across the corridors end what one sees along them after some 20 to 60 m. The
// square behind holds two strips of machines with an aisle of 2 m between them, or an open shaft with a column in it.
#include <cmath>
#include <vector>

#include "server/model/generators.h"
#include "server/model/growth_order.h"
#include "server/model/painted_textures.h"
#include "server/model/plant_equipment.h"
#include "server/model/plant_groups.h"

namespace farfield {
namespace {

constexpr float kBay = 15, kCorridor = 3, kFloorHeight = 5;
constexpr int kFloors = 5;
constexpr float kStripInset = 0.2f;  // from the corridor or the bay's edge to a strip
constexpr glm::u8vec4 kStructure{92, 112, 132, 255}, kYellow{232, 184, 36, 255}, kGalvanised{148, 154, 158, 255};
constexpr float kQuarterTurn = 1.57079632679f;

struct Bay {
  ModelBuilder& builder;
  const PlantPaints& paints;
  std::uint64_t seed;
  int i, k;  // grid coordinates along x and z
};

bool is_shaft(std::uint64_t seed, int i, int k) { return RandomStream(seed, 1, i, k).chance(0.15); }

void add_floor(const Bay& bay, int level, bool is_open, RandomStream& random) {
  const float y = kFloorHeight * static_cast<float>(level);
  ModelBuilder& b = bay.builder;
  const Frame ground = Frame::at({0, y, 0});
  if (level == 0) {
    b.try_add([&] { add_quad(b, bay.paints.concrete, ground, {0, 0, kBay}, {kBay, 0, kBay}, {kBay, 0, 0}, {0, 0, 0}); });
    return;
  }
  b.try_add([&] {  // corridor plates: a cross of two strips that share one corner square
    add_box(b, bay.paints.plate, ground, {0, -0.05f, 0}, {kBay, 0, kCorridor}, kFaceTop | kFaceBottom | kFaceFront);
    add_box(b, bay.paints.plate, ground, {0, -0.05f, kCorridor}, {kCorridor, 0, kBay}, kFaceTop | kFaceBottom | kFaceRight);
  });
  const float inner = kBay - kCorridor;
  const double kind = random.unit();
  if (is_open) {
    b.try_add([&] {
      const Paint rail = bay.paints.coloured(kYellow);
      add_railing(b, rail, Frame::at({kCorridor + 0.05f, y, kCorridor + 0.05f}), inner - 0.1f);
      add_railing(b, rail, Frame::at({kCorridor + 0.05f, y, kBay - 0.05f}), inner - 0.1f);
      add_railing(b, rail, Frame::at({kCorridor + 0.05f, y, kBay - 0.05f}, kQuarterTurn), inner - 0.1f);
      add_railing(b, rail, Frame::at({kBay - 0.05f, y, kBay - 0.05f}, kQuarterTurn), inner - 0.1f);
    });
  } else {
    const Paint& paint = kind < 0.65 ? bay.paints.grating : bay.paints.plate;
    b.try_add([&] { add_box(b, paint, ground, {kCorridor, -0.05f, kCorridor}, {kBay, 0, kBay}, kFaceTop | kFaceBottom | kFaceRight | kFaceFront); });
  }
}

// Walls across the corridors at the bay's own edges: closed, or with a doorway to walk through.
void add_walls(const Bay& bay, int level) {
  ModelBuilder& b = bay.builder;
  const float y = kFloorHeight * static_cast<float>(level), height = kFloorHeight - 0.1f;
  for (const bool along_x : {true, false}) {
    RandomStream random(bay.seed, 5, bay.i, bay.k, level, along_x);
    if (!random.chance(0.45)) continue;
    const bool is_closed = random.chance(0.55);
    const float door = random.between(0.2f, 1.2f);
    const Frame frame = along_x ? Frame::at({0, y, kCorridor}, kQuarterTurn) : Frame::at({0, y, 0});
    b.try_add([&] {
      add_partition(b, bay.paints, frame, kCorridor, height, is_closed ? -1 : door);
      if (is_closed) add_closed_door(b, bay.paints, frame.moved({0.5f * kCorridor, 0, 0}));
    });
  }
}

void add_structure(const Bay& bay, int level) {
  ModelBuilder& b = bay.builder;
  const Paint paint = bay.paints.coloured(kStructure);
  const float y = kFloorHeight * static_cast<float>(level), top = y + kFloorHeight - 0.06f;
  constexpr float kNear = kCorridor + 0.3f, kFar = kBay - 0.3f;
  for (const float x : {kNear, kFar}) {
    for (const float z : {kNear, kFar}) b.try_add([&] { add_column(b, paint, Frame::at({x, y, z}), kFloorHeight, 0.3f); });
  }
  for (const float at : {kNear, kFar}) {
    b.try_add([&] { add_beam(b, paint, Frame::at({0, top, at}), kBay, 0.36f); });
    b.try_add([&] { add_beam(b, paint, Frame::at({at, top, kBay}, kQuarterTurn), kBay, 0.3f); });
  }
  for (int k = 1; k < 4; ++k) {
    const float z = kNear + (kFar - kNear) * static_cast<float>(k) / 4;
    b.try_add([&] { add_beam(b, paint, Frame::at({kNear, top, z}), kFar - kNear, 0.2f); });
  }
}

// Pipes above one corridor. Their sizes and colours follow from the corridor, not the bay: they run on through all bays.
void add_rack(const Bay& bay, int level, bool along_x) {
  ModelBuilder& b = bay.builder;
  RandomStream line(bay.seed, 2, along_x ? bay.k : bay.i, level, along_x);
  RandomStream here(bay.seed, 3, bay.i, bay.k, level, along_x);
  const float y = kFloorHeight * static_cast<float>(level) + (along_x ? 3.25f : 3.95f);
  const auto at = [&](float along, float height, float across) {
    return along_x ? glm::vec3(along, height, across) : glm::vec3(across, height, along);
  };
  const glm::vec3 axis = at(1, 0, 0);
  float across = 0.3f;
  while (across < kCorridor - 0.25f) {
    const float radius = line.between(0.03f, 0.20f);
    const Paint paint = bay.paints.coloured(pipe_colour(line));
    across += radius;
    const float flange = here.between(1.0f, 14.0f);
    const bool has_valve = here.chance(0.05), has_flange = here.chance(0.3);
    b.try_add([&] {
      const glm::vec3 from = at(0, y + radius, across);
      add_pipe_route(b, paint, {from, from + kBay * axis}, radius, false);
      if (has_valve) {
        add_valve(b, bay.paints, from + flange * axis, axis, radius);
      } else if (has_flange) {
        add_flange(b, paint, from + flange * axis, axis, radius);
      }
    });
    across += radius + line.between(0.08f, 0.22f);
  }
  for (const float along : {4.0f, 9.0f, 14.0f}) {  // what carries them
    b.try_add([&] {
      const glm::vec3 l = at(along - 0.05f, y - 0.12f, 0.05f), h = at(along + 0.05f, y, kCorridor);
      add_box(b, bay.paints.coloured(kStructure), Frame{}, glm::min(l, h), glm::max(l, h));
      for (const float side : {0.12f, kCorridor - 0.12f}) {
        add_tube(b, bay.paints.coloured(kGalvanised), at(along, y, side), at(along, kFloorHeight * static_cast<float>(level + 1) - 0.1f, side), 0.012f, 6);
      }
    });
  }
}

// Pipes that wander through the machine area at rack height and come down to it.
void add_routes(const Bay& bay, int level, int count, RandomStream& random) {
  ModelBuilder& b = bay.builder;
  const float floor_y = kFloorHeight * static_cast<float>(level);
  for (int n = 0; n < count; ++n) {
    const float radius = random.between(0.03f, 0.13f);
    const auto along = [&] { return kCorridor + 0.7f + 0.7f * static_cast<float>(random.below(16)); };
    const auto in_a_strip = [&] { return (random.chance(0.5) ? 3.6f : 10.6f) + 0.7f * static_cast<float>(random.below(6)); };
    const float high = floor_y + random.between(3.0f, 4.4f), low = floor_y + random.between(0.3f, 2.2f);
    const float x0 = along(), z0 = in_a_strip();
    float x1 = along(), z1 = in_a_strip();
    if (std::abs(x1 - x0) < 1) x1 = x0 < 9 ? x0 + 4.2f : x0 - 4.2f;
    if (std::abs(z1 - z0) < 1) z1 = z0 < 9 ? z0 + 7.0f : z0 - 7.0f;
    const Paint paint = bay.paints.coloured(pipe_colour(random));
    std::vector<glm::vec3> points{{x0, low, z0}, {x0, high, z0}, {x1, high, z0}, {x1, high, z1}};
    if (random.chance(0.5)) points.push_back({x1, floor_y + kFloorHeight - 0.05f, z1});
    const bool has_valve = random.chance(0.25) && high - low > 1.4f;
    b.try_add([&] {
      add_pipe_route(b, paint, points, radius, true);
      if (has_valve) add_valve(b, bay.paints, {x0, 0.5f * (low + high), z0}, {0, 1, 0}, radius);
    });
  }
}

void add_strips(const Bay& bay, int level, RandomStream& random) {
  const float y = kFloorHeight * static_cast<float>(level);
  const float low = kCorridor + kStripInset, high = kBay - kStripInset;
  for (const Frame& frame : {Frame::at({low, y, low}), Frame::at({high, y, high}, 2 * kQuarterTurn)}) {
    add_machine_strip(bay.builder, bay.paints, frame, random);
    if (random.chance(0.3)) bay.builder.try_add([&] { add_partition(bay.builder, bay.paints, frame, kStripLength, kStripHeight); });
  }
}

// What stands in a shaft through all floors.
void add_tower(const Bay& bay, RandomStream& random) {
  ModelBuilder& b = bay.builder;
  const float height = kFloorHeight * kFloors + random.between(1.0f, 7.0f), middle = 0.5f * (kCorridor + kBay);
  const float radius = random.between(2.2f, 3.8f);
  b.try_add([&] { add_vertical_vessel(b, bay.paints, Frame::at({middle, 0, middle}), radius, height, random); });
  b.try_add([&] { add_ladder(b, bay.paints.coloured(kYellow), Frame::at({middle, 0, middle + radius + 0.25f}), height - 1.2f); });
}

void add_bay(const Bay& bay) {
  const bool has_shaft = is_shaft(bay.seed, bay.i, bay.k);
  for (int level = 0; level < kFloors; ++level) {
    RandomStream random(bay.seed, 4, bay.i, bay.k, level);
    const bool is_open = level > 0 && (has_shaft || random.chance(0.08));
    add_floor(bay, level, is_open, random);
    add_structure(bay, level);
    add_walls(bay, level);
    add_rack(bay, level, true);
    add_rack(bay, level, false);
    if (has_shaft && level == 0) add_tower(bay, random);
    if (!has_shaft && !is_open) add_strips(bay, level, random);
    add_routes(bay, level, is_open ? 4 : 3, random);
  }
}

}  // namespace

Model generate_pipes(std::size_t triangles, std::uint64_t seed) {
  ModelBuilder builder("pipes", triangles);
  PlantPaints paints;
  paints.steel.material = builder.add_material("painted steel");
  paints.concrete = {builder.add_material("concrete", builder.add_texture(paint_rough("concrete", {0.52f, 0.52f, 0.50f}, {0.68f, 0.67f, 0.65f}, seed))), glm::u8vec4(255), 0.25f};
  paints.plate = {builder.add_material("checker plate", builder.add_texture(paint_checker_plate(seed))), glm::u8vec4(255), 2.0f};
  paints.grating = {builder.add_material("grating", builder.add_texture(paint_grating(seed))), glm::u8vec4(255), 2.0f};
  GrowthOrder order({kBay, kBay});
  while (!builder.is_full()) {
    const glm::ivec2 at = order.next();
    builder.begin_module({kBay * at.x, 0, kBay * at.y});
    add_bay({builder, paints, seed, at.x, at.y});
  }
  fill_with_boxes(builder, paints.coloured({150, 112, 72, 255}), {3.2f, 0, 3.2f}, {9.2f, 0, 9.2f}, seed);
  return builder.finish();
}

}  // namespace farfield
