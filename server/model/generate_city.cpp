// SPDX-License-Identifier: Apache-2.0
// A city: blocks of about 74 m between streets of a slightly irregular grid, about 10 triangles per square metre.
//
// A module is one block with the streets on its low sides: roadways x < 8 m and z < 8 m at y = 0, then pavement and
// block at kerb height. Some blocks are parks.
#include <algorithm>
#include <cmath>
#include <vector>

#include "server/model/city_buildings.h"
#include "server/model/generators.h"
#include "server/model/growth_order.h"
#include "server/model/painted_textures.h"
#include "server/model/street_furniture.h"

namespace farfield {
namespace {

constexpr float kPitch = 74, kRoad = 8, kPavement = 3, kKerb = 0.13f, kRowDepth = 13;
constexpr float kHalfTurn = 3.14159265359f;

/// Where street number `index` of an axis runs, world metres.
double street_line(std::uint64_t seed, int axis, int index) {
  return kPitch * index + RandomStream(seed, 11, axis, index).between(-6.0, 6.0);
}

CityPaints make_paints(ModelBuilder& b, std::uint64_t seed) {
  const auto textured = [&](const char* name, TextureImage image, float repeats_per_m, bool is_masked = false) {
    return Paint{b.add_material(name, b.add_texture(std::move(image)), is_masked), glm::u8vec4(255), repeats_per_m};
  };
  CityPaints p;
  p.plain.material = b.add_material("painted");
  p.asphalt = textured("asphalt", paint_rough("asphalt", {0.24f, 0.24f, 0.25f}, {0.34f, 0.34f, 0.34f}, seed), 0.25f);
  p.paving = textured("paving", paint_paving({0.62f, 0.60f, 0.57f}, 8, seed + 1), 0.25f);
  p.grass = textured("grass", paint_grass(seed + 2), 0.25f);
  p.gravel = textured("gravel", paint_rough("gravel", {0.42f, 0.40f, 0.37f}, {0.60f, 0.58f, 0.54f}, seed + 3), 0.5f);
  p.roof_tiles = textured("roof tiles", paint_roof_tiles({0.66f, 0.32f, 0.22f}, seed + 4), 0.25f);
  p.shop_fronts = textured("shop fronts", paint_shop_fronts(seed + 5), 0);
  p.bark = textured("bark", paint_rough("bark", {0.26f, 0.20f, 0.15f}, {0.42f, 0.34f, 0.26f}, seed + 6), 1);
  const std::vector<FacadeStyle> styles{{{0.62f, 0.30f, 0.24f}, {0.92f, 0.90f, 0.84f}, WindowStyle::kSash, true},
                                        {{0.86f, 0.78f, 0.62f}, {0.95f, 0.93f, 0.88f}, WindowStyle::kNarrow, false},
                                        {{0.74f, 0.74f, 0.72f}, {0.40f, 0.42f, 0.44f}, WindowStyle::kWide, false},
                                        {{0.80f, 0.62f, 0.52f}, {0.94f, 0.92f, 0.88f}, WindowStyle::kSash, false},
                                        {{0.50f, 0.40f, 0.34f}, {0.82f, 0.78f, 0.70f}, WindowStyle::kNarrow, true},
                                        {{0.56f, 0.64f, 0.68f}, {0.86f, 0.88f, 0.90f}, WindowStyle::kBand, false}};
  for (std::size_t k = 0; k < styles.size(); ++k) {
    p.facades.push_back(textured("facade", paint_facade(styles[k], seed + 20 + k), 1.0f / 12));
  }
  p.leaves.push_back(textured("leaves", paint_leaves({0.30f, 0.46f, 0.16f}, seed + 40), 0, true));
  p.leaves.push_back(textured("leaves", paint_leaves({0.42f, 0.50f, 0.18f}, seed + 41), 0, true));
  return p;
}

struct Block {
  ModelBuilder& builder;
  const CityPaints& paints;
  glm::vec2 size;  // with the streets on its low sides
  RandomStream random;
};

// A horizontal rectangle, texture aligned to the module.
void add_ground(Block& block, const Paint& paint, glm::vec2 low, glm::vec2 high, float y) {
  const glm::vec2 l = low * paint.repeats_per_m, h = high * paint.repeats_per_m;
  block.builder.try_add([&] {
    add_quad(block.builder, paint, Frame{}, {low.x, y, high.y}, {high.x, y, high.y}, {high.x, y, low.y}, {low.x, y, low.y}, {l.x, h.y}, {h.x, l.y});
  });
}

void add_streets(Block& block) {
  ModelBuilder& b = block.builder;
  const glm::vec2 s = block.size;
  add_ground(block, block.paints.asphalt, {0, 0}, {s.x, kRoad}, 0);
  add_ground(block, block.paints.asphalt, {0, kRoad}, {kRoad, s.y}, 0);
  const Paint stone = block.paints.coloured({176, 172, 166, 255}), white = block.paints.coloured({226, 226, 220, 255});
  constexpr float kStone = 0.16f;
  b.try_add([&] {  // kerb stones around the block
    const Frame f{};
    add_box(b, stone, f, {kRoad, 0, kRoad}, {s.x, kKerb, kRoad + kStone}, kFaceTop | kFaceBack | kFaceLeft | kFaceRight);
    add_box(b, stone, f, {kRoad, 0, s.y - kStone}, {s.x, kKerb, s.y}, kFaceTop | kFaceFront | kFaceLeft | kFaceRight);
    add_box(b, stone, f, {kRoad, 0, kRoad + kStone}, {kRoad + kStone, kKerb, s.y - kStone}, kFaceTop | kFaceLeft);
    add_box(b, stone, f, {s.x - kStone, 0, kRoad + kStone}, {s.x, kKerb, s.y - kStone}, kFaceTop | kFaceRight);
  });
  const float in = kRoad + kStone, far_x = s.x - kStone, far_z = s.y - kStone, ring = kRoad + kPavement;
  add_ground(block, block.paints.paving, {in, in}, {far_x, ring}, kKerb);
  add_ground(block, block.paints.paving, {in, s.y - kPavement}, {far_x, far_z}, kKerb);
  add_ground(block, block.paints.paving, {in, ring}, {ring, s.y - kPavement}, kKerb);
  add_ground(block, block.paints.paving, {s.x - kPavement, ring}, {far_x, s.y - kPavement}, kKerb);
  add_ground(block, block.paints.grass, {ring, ring}, {s.x - kPavement, s.y - kPavement}, kKerb);
  const auto marking = [&](glm::vec2 low, glm::vec2 high) {
    b.try_add([&] { add_box(b, white, Frame{}, {low.x, 0, low.y}, {high.x, 0.012f, high.y}, kAllFaces & ~kFaceBottom); });
  };
  for (float t = kRoad + 5; t < s.x - 4; t += 6) marking({t, 0.5f * kRoad - 0.07f}, {t + 3, 0.5f * kRoad + 0.07f});
  for (float t = kRoad + 5; t < s.y - 4; t += 6) marking({0.5f * kRoad - 0.07f, t}, {0.5f * kRoad + 0.07f, t + 3});
  for (float t = 0.5f; t < kRoad - 0.5f; t += 1) {  // zebra crossings
    marking({t, kRoad + 0.5f}, {t + 0.5f, kRoad + 3.2f});
    marking({kRoad + 0.5f, t}, {kRoad + 3.2f, t + 0.5f});
  }
}

// Houses side by side over `length` metres; `origin` is the back left corner of the row as seen from its street's far side.
void add_row(Block& block, const Frame& row, float length, int mean_floors) {
  float x = 0;
  while (length - x > 1) {
    float width = block.random.between(9.0f, 17.0f);
    if (length - x - width < 8) width = length - x;
    const int floors = std::max(2, mean_floors + block.random.between(-1, 2));
    const float depth = kRowDepth - block.random.between(0.0f, 0.8f);
    const Frame lot = row.moved({x, 0, kRowDepth - depth});
    block.builder.try_add([&] { add_building(block.builder, block.paints, lot, {width, depth}, floors, block.random); });
    x += width;
  }
}

void add_houses(Block& block) {
  const glm::vec2 low{kRoad + kPavement, kRoad + kPavement}, high = block.size - kPavement;
  const int floors = block.random.chance(0.12) ? 11 : block.random.between(3, 6);
  const float width = high.x - low.x, side = high.y - low.y - 2 * kRowDepth;
  add_row(block, Frame::at({low.x, kKerb, high.y - kRowDepth}), width, floors);
  add_row(block, Frame::at({high.x, kKerb, low.y + kRowDepth}, kHalfTurn), width, floors);
  if (block.random.chance(0.75)) add_row(block, Frame::at({high.x - kRowDepth, kKerb, high.y - kRowDepth}, 0.5f * kHalfTurn), side, floors);
  if (block.random.chance(0.75)) add_row(block, Frame::at({low.x + kRowDepth, kKerb, low.y + kRowDepth}, -0.5f * kHalfTurn), side, floors);
}

void add_trees(Block& block, glm::vec2 low, glm::vec2 high, int count) {
  for (int k = 0; k < count; ++k) {
    const glm::vec3 at{block.random.between(low.x, high.x), kKerb, block.random.between(low.y, high.y)};
    const float height = block.random.between(6.0f, 12.0f);
    const Paint& leaves = block.random.pick(block.paints.leaves);
    block.builder.try_add([&] { add_tree(block.builder, block.paints.bark, leaves, Frame::at(at), height, block.random); });
  }
}

void add_park(Block& block) {
  const glm::vec2 low{kRoad + kPavement, kRoad + kPavement}, high = block.size - kPavement, middle = 0.5f * (low + high);
  add_ground(block, block.paints.gravel, {low.x, middle.y - 1.5f}, {high.x, middle.y + 1.5f}, kKerb + 0.015f);
  add_ground(block, block.paints.gravel, {middle.x - 1.5f, low.y}, {middle.x + 1.5f, middle.y - 1.5f}, kKerb + 0.015f);
  add_ground(block, block.paints.gravel, {middle.x - 1.5f, middle.y + 1.5f}, {middle.x + 1.5f, high.y}, kKerb + 0.015f);
  for (float x = low.x + 6; x < high.x - 4; x += 9) {
    const Frame at = Frame::at({x, kKerb, middle.y - 2.0f});
    block.builder.try_add([&] { add_bench(block.builder, block.paints.plain, at); });
  }
  for (const glm::vec2 quarter : {low, {middle.x + 3, low.y}, {low.x, middle.y + 3}, middle + 3.0f}) {
    add_trees(block, quarter + 2.0f, quarter + (middle - low) - 5.0f, 11);
  }
}

void add_street_life(Block& block) {
  ModelBuilder& b = block.builder;
  RandomStream& random = block.random;
  for (const bool along_x : {true, false}) {
    const float length = along_x ? block.size.x : block.size.y;
    const auto place = [&](float along, float across, float y, float turn) {
      return along_x ? Frame::at({along, y, across}, turn) : Frame::at({across, y, along}, turn - 0.5f * kHalfTurn);
    };
    for (float t = kRoad + 6; t < length - 5; t += 6) {
      const float lean = random.between(-0.03f, 0.03f);
      const bool is_parked = random.chance(0.55);
      const float turn = lean + (random.chance(0.5) ? kHalfTurn : 0);
      if (is_parked) b.try_add([&] { add_car(b, block.paints.plain, place(t, kRoad - 1.15f, 0, turn), random); });
    }
    for (float t = kRoad + 8; t < length - 4; t += 10) {
      const float height = random.between(5.0f, 8.0f);
      const Paint& leaves = random.pick(block.paints.leaves);
      b.try_add([&] { add_tree(b, block.paints.bark, leaves, place(t, kRoad + 0.7f, kKerb, 0), height, random); });
    }
    for (float t = kRoad + 3; t < length; t += 30) {
      b.try_add([&] { add_street_lamp(b, block.paints.plain, place(t, kRoad + 0.45f, kKerb, along_x ? 0.5f * kHalfTurn : 1.5f * kHalfTurn)); });
    }
  }
}

}  // namespace

Model generate_city(std::size_t triangles, std::uint64_t seed) {
  ModelBuilder builder("city", triangles);
  const CityPaints paints = make_paints(builder, seed);
  GrowthOrder order({kPitch, kPitch});
  glm::vec2 size{kPitch};
  while (!builder.is_full()) {
    const glm::ivec2 at = order.next();
    const glm::dvec2 corner{street_line(seed, 0, at.x), street_line(seed, 1, at.y)};
    size = glm::vec2(glm::dvec2(street_line(seed, 0, at.x + 1), street_line(seed, 1, at.y + 1)) - corner);
    builder.begin_module({corner.x, 0, corner.y});
    Block block{builder, paints, size, RandomStream(seed, 12, at.x, at.y)};
    add_streets(block);
    if (block.random.chance(0.1)) {
      add_park(block);
    } else {
      add_houses(block);
      const float inset = kRoad + kPavement + kRowDepth + 3;
      add_trees(block, {inset, inset}, size - kPavement - kRowDepth - 3.0f, 9);
    }
    add_street_life(block);
  }
  const float inset = kRoad + kPavement + kRowDepth + 1;  // boxes in the last courtyard
  fill_with_boxes(builder, paints.coloured({150, 120, 84, 255}), {inset, kKerb, inset},
                  {size.x - kPavement - kRowDepth, kKerb, size.y - kPavement - kRowDepth}, seed);
  return builder.finish();
}

}  // namespace farfield
