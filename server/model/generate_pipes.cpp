// SPDX-License-Identifier: Apache-2.0
// A power plant: square bays of 10 m over five floors, about 350 triangles per square metre of ground.
//
// In each bay the strips x < 2.4 m and z < 2.4 m are corridors on every floor, free up to 3 m; the pipes of the racks
// run above head height. The square behind them holds columns, machines, vessels, gratings or an open shaft.
#include <cmath>
#include <vector>

#include "server/model/generators.h"
#include "server/model/growth_order.h"
#include "server/model/painted_textures.h"
#include "server/model/plant_equipment.h"

namespace farfield {
namespace {

constexpr float kBay = 10, kCorridor = 2.4f, kFloorHeight = 5;
constexpr int kFloors = 5;
constexpr glm::u8vec4 kStructure{92, 112, 132, 255}, kYellow{232, 184, 36, 255}, kGalvanised{148, 154, 158, 255};
constexpr float kQuarterTurn = 1.57079632679f;

struct Bay {
  ModelBuilder& builder;
  const PlantPaints& paints;
  std::uint64_t seed;
  int i, k;  // grid coordinates along x and z
};

bool is_shaft(std::uint64_t seed, int i, int k) { return RandomStream(seed, 1, i, k).chance(0.18); }

void add_floor(const Bay& bay, int level, bool has_shaft, RandomStream& random) {
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
  if (has_shaft || kind < 0.2) {
    b.try_add([&] {
      const Paint rail = bay.paints.coloured(kYellow);
      add_railing(b, rail, Frame::at({kCorridor + 0.05f, y, kCorridor + 0.05f}), inner - 0.1f);
      add_railing(b, rail, Frame::at({kCorridor + 0.05f, y, kBay - 0.05f}), inner - 0.1f);
      add_railing(b, rail, Frame::at({kCorridor + 0.05f, y, kBay - 0.05f}, kQuarterTurn), inner - 0.1f);
      add_railing(b, rail, Frame::at({kBay - 0.05f, y, kBay - 0.05f}, kQuarterTurn), inner - 0.1f);
    });
  } else if (kind < 0.6) {
    b.try_add([&] { add_grating(b, bay.paints.coloured(kGalvanised), Frame::at({kCorridor, y, kCorridor}), {inner, inner}); });
  } else {
    b.try_add([&] { add_box(b, bay.paints.plate, ground, {kCorridor, -0.05f, kCorridor}, {kBay, 0, kBay}, kFaceTop | kFaceBottom | kFaceRight | kFaceFront); });
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
    const float radius = line.between(0.03f, 0.15f);
    const Paint paint = bay.paints.coloured(pipe_colour(line));
    across += radius;
    const float flange = here.between(1.0f, 9.0f);
    const bool has_valve = here.chance(0.10), has_flange = here.chance(0.5);
    b.try_add([&] {
      const glm::vec3 from = at(0, y + radius, across);
      add_pipe_route(b, paint, {from, from + kBay * axis}, radius, false);
      if (has_valve) {
        add_valve(b, bay.paints, from + flange * axis, axis, radius);
      } else if (has_flange) {
        add_flange(b, paint, from + flange * axis, axis, radius);
      }
    });
    across += radius + line.between(0.10f, 0.24f);
  }
  for (const float along : {3.4f, 8.4f}) {  // what carries them
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
    const auto coordinate = [&] { return kCorridor + 0.7f + 0.7f * static_cast<float>(random.below(9)); };
    const float high = floor_y + random.between(3.0f, 4.4f), low = floor_y + random.between(0.3f, 2.2f);
    const float x0 = coordinate(), z0 = coordinate();
    float x1 = coordinate(), z1 = coordinate();
    if (std::abs(x1 - x0) < 0.6f) x1 = x0 < 6 ? x0 + 1.4f : x0 - 1.4f;
    if (std::abs(z1 - z0) < 0.6f) z1 = z0 < 6 ? z0 + 1.4f : z0 - 1.4f;
    const Paint paint = bay.paints.coloured(pipe_colour(random));
    std::vector<glm::vec3> points{{x0, low, z0}, {x0, high, z0}, {x1, high, z0}, {x1, high, z1}};
    if (random.chance(0.5)) points.push_back({x1, floor_y + kFloorHeight - 0.05f, z1});
    const bool has_valve = random.chance(0.4) && high - low > 1.4f;
    b.try_add([&] {
      add_pipe_route(b, paint, points, radius, true);
      if (has_valve) add_valve(b, bay.paints, {x0, 0.5f * (low + high), z0}, {0, 1, 0}, radius);
    });
  }
}

void add_machines(const Bay& bay, int level, RandomStream& random) {
  ModelBuilder& b = bay.builder;
  const float y = kFloorHeight * static_cast<float>(level);
  const float middle = 0.5f * (kCorridor + kBay);
  switch (random.below(7)) {
    case 0:
      for (int k = 0; k < 3; ++k) {
        b.try_add([&] { add_pump(b, bay.paints, Frame::at({4.4f, y, 3.9f + 2.1f * static_cast<float>(k)}), random); });
      }
      break;
    case 1:
      b.try_add([&] { add_drum(b, bay.paints, Frame::at({middle, y, middle - 1.4f}), 1.0f, 5.4f, random); });
      break;
    case 2:
      for (const float z : {middle - 1.7f, middle + 1.4f}) {
        b.try_add([&] { add_exchanger(b, bay.paints, Frame::at({middle, y, z}), 5.2f, random); });
      }
      break;
    case 3:
      for (const float x : {middle - 1.7f, middle + 1.7f}) {
        for (const float z : {middle - 1.7f, middle + 1.7f}) {
          b.try_add([&] { add_vertical_vessel(b, bay.paints, Frame::at({x, y, z}), random.between(0.6f, 1.1f), random.between(3.0f, 4.2f), random); });
        }
      }
      break;
    case 4:
      for (int k = 0; k < 6; ++k) {
        b.try_add([&] { add_cabinet(b, bay.paints, Frame::at({3.6f + 0.82f * static_cast<float>(k), y, 8.6f}), random); });
        b.try_add([&] { add_cabinet(b, bay.paints, Frame::at({3.6f + 0.82f * static_cast<float>(k), y, 5.0f}, 2 * kQuarterTurn), random); });
      }
      break;
    case 5:
      for (const float z : {4.2f, 7.0f}) {
        b.try_add([&] { add_duct(b, bay.paints, Frame::at({kCorridor + 0.6f, y + 2.3f, z}), 6.4f, {0.9f, 0.7f}); });
      }
      b.try_add([&] { add_drum(b, bay.paints, Frame::at({middle, y, middle + 2.0f}), 0.6f, 4.0f, random); });
      break;
    default:  // a manifold: a header with a row of valves
      for (int k = 0; k < 7; ++k) {
        b.try_add([&] {
          const glm::vec3 at{3.7f + 0.8f * static_cast<float>(k), y + 0.8f, 6.0f};
          add_pipe_route(b, bay.paints.coloured(pipe_colour(random)), {at, at + glm::vec3(0, 0, 1.6f), at + glm::vec3(0, 2.6f, 1.6f)}, 0.06f, true);
          add_valve(b, bay.paints, at + glm::vec3(0, 0, 0.7f), {0, 0, 1}, 0.06f);
        });
      }
      b.try_add([&] { add_pipe_route(b, bay.paints.coloured(pipe_colour(random)), {{3.2f, y + 0.8f, 6.0f}, {9.2f, y + 0.8f, 6.0f}}, 0.16f, true); });
  }
}

void add_bay(const Bay& bay) {
  ModelBuilder& b = bay.builder;
  const bool has_shaft = is_shaft(bay.seed, bay.i, bay.k);
  for (int level = 0; level < kFloors; ++level) {
    RandomStream random(bay.seed, 4, bay.i, bay.k, level);
    add_floor(bay, level, has_shaft, random);
    add_structure(bay, level);
    add_rack(bay, level, true);
    add_rack(bay, level, false);
    if (has_shaft) {
      if (level == 0) {
        const float height = kFloorHeight * kFloors + random.between(1.0f, 7.0f), middle = 0.5f * (kCorridor + kBay);
        const float radius = random.between(1.3f, 2.3f);
        b.try_add([&] { add_vertical_vessel(b, bay.paints, Frame::at({middle, 0, middle}), radius, height, random); });
        b.try_add([&] { add_ladder(b, bay.paints.coloured(kYellow), Frame::at({middle, 0, middle + radius + 0.25f}), height - 1.2f); });
      }
      add_routes(bay, level, 3, random);
    } else {
      add_machines(bay, level, random);
      add_routes(bay, level, 2, random);
    }
  }
}

}  // namespace

Model generate_pipes(std::size_t triangles, std::uint64_t seed) {
  ModelBuilder builder("pipes", triangles);
  PlantPaints paints;
  paints.steel.material = builder.add_material("painted steel");
  paints.concrete = {builder.add_material("concrete", builder.add_texture(paint_rough("concrete", {0.52f, 0.52f, 0.50f}, {0.68f, 0.67f, 0.65f}, seed))), glm::u8vec4(255), 0.25f};
  paints.plate = {builder.add_material("checker plate", builder.add_texture(paint_checker_plate(seed))), glm::u8vec4(255), 2.0f};
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
