// SPDX-License-Identifier: Apache-2.0
// A building of many rooms on three floors: wings of rooms along a corridor, joined by passages across courtyards.
//
// A module is 4.5 m of one wing, z from its south wall: room 0.3 … 5.2, corridor 5.35 … 7.25, room 7.4 … 12.3, wall
// to 12.6, courtyard to 18. Every eighth module along a wing is a passage instead of rooms. Doors are 1.05 m wide.
#include <array>
#include <set>
#include <utility>
#include <vector>

#include "server/model/generators.h"
#include "server/model/growth_order.h"
#include "server/model/house_rooms.h"
#include "server/model/painted_textures.h"

namespace farfield {
namespace {

constexpr int kFloors = 3, kPassageEvery = 8;
constexpr float kWidth = 4.5f, kPitch = 18, kWing = 12.6f, kStorey = 3.1f, kClear = 2.8f;
constexpr float kOuter = 0.3f, kInner = 0.15f;
constexpr float kSouthCorridor = 5.275f, kNorthCorridor = 7.325f;  // middles of the corridor's walls
constexpr float kPassageLeft = 1.2f, kPassageRight = 3.3f;
constexpr float kHalfTurn = 3.14159265359f;

struct Module {
  ModelBuilder& builder;
  const HousePaints& paints;
  std::uint64_t seed;
  int i, k;
  bool is_passage() const { return ((i % kPassageEvery) + kPassageEvery) % kPassageEvery == 0; }
};

HousePaints make_paints(ModelBuilder& b, std::uint64_t seed) {
  const auto textured = [&](const char* name, TextureImage image, float repeats_per_m, bool is_masked = false) {
    return Paint{b.add_material(name, b.add_texture(std::move(image)), is_masked), glm::u8vec4(255), repeats_per_m};
  };
  HousePaints p;
  p.plain.material = b.add_material("painted");
  p.plaster = textured("plaster", paint_rough("plaster", {0.85f, 0.83f, 0.78f}, {0.90f, 0.88f, 0.84f}, seed, 0.08f), 0.25f);
  p.concrete = textured("stone", paint_rough("stone", {0.46f, 0.46f, 0.47f}, {0.62f, 0.62f, 0.62f}, seed + 1), 0.5f);
  p.brick = textured("bricks", paint_bricks({0.66f, 0.36f, 0.28f}, seed + 2), 0.5f);
  p.wood = textured("light wood", paint_wood({0.80f, 0.62f, 0.40f}, 4, seed + 3), 0.5f);
  p.dark_wood = textured("dark wood", paint_wood({0.50f, 0.32f, 0.20f}, 4, seed + 4), 0.5f);
  p.parquet = textured("parquet", paint_wood({0.74f, 0.54f, 0.34f}, 16, seed + 5), 0.5f);
  p.tiles = textured("tiles", paint_paving({0.80f, 0.78f, 0.74f}, 8, seed + 6), 0.5f);
  p.fabric = textured("fabric", paint_rough("fabric", {0.78f, 0.78f, 0.78f}, {0.95f, 0.95f, 0.95f}, seed + 7), 1.0f);
  p.grass = textured("grass", paint_grass(seed + 8), 0.25f);
  p.leaves = textured("leaves", paint_leaves({0.26f, 0.44f, 0.18f}, seed + 9), 0, true);
  const std::array<std::pair<glm::vec3, glm::vec3>, 4> papers{{{{0.88f, 0.84f, 0.74f}, {0.70f, 0.56f, 0.42f}}, {{0.74f, 0.80f, 0.80f}, {0.50f, 0.62f, 0.66f}}, {{0.80f, 0.82f, 0.70f}, {0.56f, 0.62f, 0.44f}}, {{0.88f, 0.76f, 0.70f}, {0.70f, 0.46f, 0.42f}}}};
  for (std::size_t n = 0; n < papers.size(); ++n) p.wallpapers.push_back(textured("wallpaper", paint_wallpaper(papers[n].first, papers[n].second, seed + 10 + n), 1));
  p.carpets.push_back(textured("carpet", paint_carpet({0.50f, 0.16f, 0.16f}, {0.74f, 0.56f, 0.30f}, seed + 20), 0.5f));
  p.carpets.push_back(textured("carpet", paint_carpet({0.18f, 0.26f, 0.42f}, {0.62f, 0.62f, 0.56f}, seed + 21), 0.5f));
  return p;
}

void add_level_quad(const Module& m, const Paint& paint, glm::vec2 low, glm::vec2 high, float y, bool faces_up) {
  m.builder.try_add([&] {
    if (faces_up) {
      add_quad(m.builder, paint, Frame{}, {low.x, y, high.y}, {high.x, y, high.y}, {high.x, y, low.y}, {low.x, y, low.y});
    } else {
      add_quad(m.builder, paint, Frame{}, {low.x, y, low.y}, {high.x, y, low.y}, {high.x, y, high.y}, {low.x, y, high.y});
    }
  });
}

void add_floor_and_ceiling(const Module& m, const Paint& floor, glm::vec2 low, glm::vec2 high, float y) {
  add_level_quad(m, floor, low, high, y, true);
  add_level_quad(m, m.paints.plaster, low, high, y + kClear, false);
}

void wall(const Module& m, const Paint& front, const Paint& back, const Frame& frame, float length, float height, float thickness, std::vector<Opening> openings) {
  m.builder.try_add([&] { add_wall(m.builder, front, back, m.paints.plaster, frame, length, height, thickness, openings); });
}

// Room, window wall and corridor wall of one side. `room`: see house_rooms.h; `left`: how far its walls reach beyond x = 0.
void add_room(const Module& m, const Frame& room, float left, RandomStream& random) {
  const Paint& paper = random.pick(m.paints.wallpapers);
  const Opening window{left + 1.25f, left + 2.95f, 0.9f, 2.35f};
  const Frame outside = room.moved({-left, 0, -kOuter});
  wall(m, paper, m.paints.brick, outside, kWidth, kStorey, kOuter, {window});
  m.builder.try_add([&] { add_window(m.builder, m.paints, outside, window, kOuter); });
  // Seen from the room the corridor wall runs the other way: its door starts 1.5 m from the room's left wall.
  const float from = kRoomWidth + 0.15f - left;
  const Frame inside = room.moved({from, 0, kRoomDepth + kInner}, kHalfTurn);
  const Opening door{from - 1.5f, from - 0.45f, 0, 2.1f};
  wall(m, paper, m.paints.plaster, inside, kWidth, kClear, kInner, {door});
  m.builder.try_add([&] { add_door(m.builder, m.paints, inside, door, kInner); });
  furnish_room(m.builder, m.paints, room, random);
}

// The wall between this module and the one before it along the wing, on both sides of the corridor.
void add_partitions(const Module& m, float y, RandomStream& random) {
  const Paint& paper = random.pick(m.paints.wallpapers);
  const Module before{m.builder, m.paints, m.seed, m.i - 1, m.k};
  const bool may_connect = !m.is_passage() && !before.is_passage();
  const float north = kWing - kOuter - kRoomDepth;
  std::vector<Opening> south_door, north_door;
  if (may_connect && random.chance(0.3)) south_door.push_back({3.4f, 4.4f, 0, 2.1f});
  if (may_connect && random.chance(0.3)) north_door.push_back({0.5f, 1.5f, 0, 2.1f});
  wall(m, paper, paper, Frame::at({kInner, y, kOuter}, -0.5f * kHalfTurn), kRoomDepth, kClear, kInner, south_door);
  wall(m, paper, paper, Frame::at({kInner, y, north}, -0.5f * kHalfTurn), kRoomDepth, kClear, kInner, north_door);
}

void add_passage(const Module& m, float y) {
  const Paint &plaster = m.paints.plaster, &brick = m.paints.brick;
  const Opening way{kPassageLeft, kPassageRight, 0, 2.4f};
  const Frame along_x = Frame::at({0, y, 0});
  wall(m, plaster, brick, along_x, kWidth, kStorey, kOuter, {way});
  wall(m, plaster, plaster, along_x.moved({0, 0, kSouthCorridor - 0.5f * kInner}), kWidth, kClear, kInner, {way});
  wall(m, plaster, plaster, along_x.moved({0, 0, kNorthCorridor - 0.5f * kInner}), kWidth, kClear, kInner, {way});
  for (const float x : {0.0f, kPassageRight + kInner}) {  // the wing's north wall beside the passage
    wall(m, brick, plaster, along_x.moved({x, 0, kWing - kOuter}), x > 0 ? kWidth - x : kPassageLeft - kInner, kStorey, kOuter, {});
  }
  // Side walls run along z; their front looks towards -x.
  const Opening window{kWing - kNorthCorridor + 1.6f, kPitch - kNorthCorridor - 1.6f, 0.9f, 2.35f};
  for (const bool is_left : {true, false}) {
    const float x = is_left ? kPassageLeft : kPassageRight + kInner;
    const Frame south = Frame::at({x, y, kOuter}, -0.5f * kHalfTurn), north = Frame::at({x, y, kNorthCorridor + 0.5f * kInner}, -0.5f * kHalfTurn);
    const Paint &front = is_left ? brick : plaster, &back = is_left ? plaster : brick;
    wall(m, front, back, south, kSouthCorridor - 0.5f * kInner - kOuter, kClear, kInner, {});
    wall(m, front, back, north, kPitch - kNorthCorridor - 0.5f * kInner, kStorey, kInner, {window});
    m.builder.try_add([&] { add_window(m.builder, m.paints, north, window, kInner); });
  }
  const glm::vec2 low{kPassageLeft, 0}, high{kPassageRight, kSouthCorridor};
  add_floor_and_ceiling(m, m.paints.tiles, low, high, y);
  add_floor_and_ceiling(m, m.paints.tiles, {kPassageLeft, kNorthCorridor}, {kPassageRight, kPitch}, y);
}

void add_roof(const Module& m) {
  const float y = kStorey * kFloors;
  add_level_quad(m, m.paints.concrete, {0, 0}, {kWidth, kWing}, y, true);
  for (const float z : {0.0f, kWing - kOuter}) {
    m.builder.try_add([&] { add_box(m.builder, m.paints.brick, Frame{}, {0, y, z}, {kWidth, y + 0.6f, z + kOuter}, kFaceTop | kFaceFront | kFaceBack); });
  }
  if (m.is_passage()) add_level_quad(m, m.paints.concrete, {kPassageLeft - kInner, kWing}, {kPassageRight + kInner, kPitch}, y, true);
}

void add_module(const Module& m) {
  m.builder.begin_module({kWidth * m.i, 0, kPitch * m.k});
  RandomStream style(m.seed, 51, m.k);
  const Paint& carpet = style.pick(m.paints.carpets);
  if (m.is_passage()) {  // the courtyard on both sides of it
    add_level_quad(m, m.paints.grass, {0, kWing}, {kPassageLeft - kInner, kPitch}, 0, true);
    add_level_quad(m, m.paints.grass, {kPassageRight + kInner, kWing}, {kWidth, kPitch}, 0, true);
  } else {
    add_level_quad(m, m.paints.grass, {0, kWing}, {kWidth, kPitch}, 0, true);
  }
  for (int level = 0; level < kFloors; ++level) {
    const float y = kStorey * static_cast<float>(level);
    RandomStream random(m.seed, 52, m.i, m.k, level);
    add_floor_and_ceiling(m, carpet, {0, kSouthCorridor}, {kWidth, kNorthCorridor}, y);
    if (m.is_passage()) {
      add_passage(m, y);
      add_partitions(m, y, random);
    } else {
      for (const glm::vec2 side : {glm::vec2(0, kSouthCorridor), {kNorthCorridor, kWing}}) {
        const Paint& floor = random.chance(0.5) ? m.paints.parquet : random.chance(0.5) ? m.paints.tiles : random.pick(m.paints.carpets);
        add_floor_and_ceiling(m, floor, {0, side.x}, {kWidth, side.y}, y);
      }
      add_partitions(m, y, random);
      add_room(m, Frame::at({kInner, y, kOuter}), kInner, random);
      add_room(m, Frame::at({kWidth, y, kWing - kOuter}, kHalfTurn), 0, random);
    }
    m.builder.try_add([&] { add_ceiling_lamp(m.builder, m.paints, Frame::at({0.5f * kWidth, y + kClear, 6.3f})); });
  }
  add_roof(m);
}

// Closes the building where no module follows.
void close_ends(const Module& m, const std::set<std::pair<int, int>>& built) {
  const Paint &brick = m.paints.brick, &plaster = m.paints.plaster;
  const auto is_built = [&](int i, int k) { return built.contains({i, k}); };
  const Opening window{5.7f, 6.9f, 0.9f, 2.35f};
  for (int level = 0; level < kFloors; ++level) {
    const float y = kStorey * static_cast<float>(level);
    if (!is_built(m.i - 1, m.k)) wall(m, brick, plaster, Frame::at({0, y, 0}, -0.5f * kHalfTurn), kWing, kStorey, kOuter, {window});
    if (!is_built(m.i + 1, m.k)) wall(m, plaster, brick, Frame::at({kWidth + kOuter, y, 0}, -0.5f * kHalfTurn), kWing, kStorey, kOuter, {window});
    if (level == 0) {  // garden walls at the courtyard's ends
      constexpr float kGardenWall = 2.4f;
      if (!is_built(m.i - 1, m.k)) wall(m, brick, brick, Frame::at({0, y, kWing}, -0.5f * kHalfTurn), kPitch - kWing, kGardenWall, kOuter, {});
      if (!is_built(m.i + 1, m.k)) wall(m, brick, brick, Frame::at({kWidth + kOuter, y, kWing}, -0.5f * kHalfTurn), kPitch - kWing, kGardenWall, kOuter, {});
    }
    if (!m.is_passage()) continue;
    const float width = kPassageRight - kPassageLeft;
    if (!is_built(m.i, m.k - 1)) wall(m, plaster, brick, Frame::at({kPassageLeft, y, -0.1f}), width, kStorey, 0.1f, {{0.4f, 1.7f, 0.9f, 2.35f}});
    if (!is_built(m.i, m.k + 1)) wall(m, brick, plaster, Frame::at({kPassageLeft, y, kPitch}), width, kStorey, 0.1f, {{0.4f, 1.7f, 0.9f, 2.35f}});
  }
}

}  // namespace

Model generate_house(std::size_t triangles, std::uint64_t seed) {
  const std::size_t reserve = triangles / 100;  // for the end walls
  ModelBuilder builder("house", triangles - reserve);
  const HousePaints paints = make_paints(builder, seed);
  GrowthOrder order({kWidth, kPitch});
  std::set<std::pair<int, int>> built;
  while (!builder.is_full()) {
    const glm::ivec2 at = order.next();
    add_module({builder, paints, seed, at.x + 1, at.y});  // + 1: the first module has rooms
    built.insert({at.x + 1, at.y});
  }
  builder.raise_budget(reserve);
  for (const auto& [i, k] : built) {
    builder.begin_module({kWidth * i, 0, kPitch * k});
    close_ends({builder, paints, seed, i, k}, built);
  }
  builder.begin_module({kWidth, 0, 0});  // flower boxes in the first courtyard
  fill_with_boxes(builder, paints.coloured({150, 112, 72, 255}), {0.3f, 0.0f, kWing + 1.0f}, {kWidth - 0.3f, 0.0f, kPitch - 0.5f}, seed);
  return builder.finish();
}

}  // namespace farfield
