// SPDX-License-Identifier: Apache-2.0
#include "server/model/city_buildings.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace farfield {
namespace {

constexpr float kFloorHeight = 3.0f, kGroundFloorHeight = 4.0f, kWindowBay = 3.0f;
constexpr float kHalfTurn = 3.14159265359f;
constexpr unsigned kAllButBack = kAllFaces & ~kFaceBack;

// One wall of the house, from the outside: its frame has x along the wall, z outwards.
struct Wall {
  Frame frame;
  float length;
  bool is_front;
  int bays() const { return std::max(1, static_cast<int>(std::lround(length / kWindowBay))); }
  float bay_width() const { return length / static_cast<float>(bays()); }
};

std::array<Wall, 4> walls_of(const Frame& frame, glm::vec2 size) {
  return {{{frame.moved({0, 0, size.y}), size.x, true},
           {frame.moved({size.x, 0, size.y}, 0.5f * kHalfTurn), size.y, false},
           {frame.moved({size.x, 0, 0}, kHalfTurn), size.x, false},
           {frame.moved({0, 0, 0}, -0.5f * kHalfTurn), size.y, false}}};
}

void add_facade(ModelBuilder& builder, const CityPaints& paints, const Paint& facade, const Wall& wall, int floors,
                bool has_shops, RandomStream& random) {
  const float top = kGroundFloorHeight + kFloorHeight * static_cast<float>(floors - 1);
  const float u = 0.25f * static_cast<float>(wall.bays());
  const float row = 0.25f * static_cast<float>(random.below(4));
  const float shop = 0.25f * static_cast<float>(random.below(4));
  if (has_shops && wall.is_front) {
    add_quad(builder, paints.shop_fronts, wall.frame, {0, 0, 0}, {wall.length, 0, 0}, {wall.length, kGroundFloorHeight, 0},
             {0, kGroundFloorHeight, 0}, {shop, 1}, {shop + std::max(0.25f, 0.25f * std::round(wall.length / 4)), 0});
  } else {
    add_quad(builder, facade, wall.frame, {0, 0, 0}, {wall.length, 0, 0}, {wall.length, kGroundFloorHeight, 0},
             {0, kGroundFloorHeight, 0}, {0, row}, {u, row - 0.25f});
  }
  add_quad(builder, facade, wall.frame, {0, kGroundFloorHeight, 0}, {wall.length, kGroundFloorHeight, 0}, {wall.length, top, 0},
           {0, top, 0}, {0, row}, {u, row - 0.25f * static_cast<float>(floors - 1)});
}

// Sills under the windows, cornices, a string course, balconies with bars and a drain pipe.
void add_relief(ModelBuilder& builder, const CityPaints& paints, const Wall& wall, int floors, const glm::u8vec4& trim,
                bool has_balconies, RandomStream& random) {
  const Paint paint = paints.coloured(trim), iron = paints.coloured({52, 56, 60, 255});
  const float top = kGroundFloorHeight + kFloorHeight * static_cast<float>(floors - 1);
  for (int floor = 1; floor < floors; ++floor) {
    const float y = kGroundFloorHeight + kFloorHeight * static_cast<float>(floor - 1);
    for (int bay = 0; bay < wall.bays(); ++bay) {
      const float x = wall.bay_width() * (static_cast<float>(bay) + 0.5f);
      add_box(builder, paint, wall.frame, {x - 0.75f, y + 0.62f, 0}, {x + 0.75f, y + 0.70f, 0.14f}, kAllButBack);
      if (has_balconies && bay % 2 == 1) {
        add_box(builder, paint, wall.frame, {x - 1.2f, y + 0.02f, 0}, {x + 1.2f, y + 0.16f, 1.0f}, kAllButBack);
        for (int k = 0; k <= 16; ++k) {
          const float s = x - 1.15f + 2.3f * static_cast<float>(k) / 16;
          add_box(builder, iron, wall.frame, {s - 0.012f, y + 0.16f, 0.93f}, {s + 0.012f, y + 1.1f, 0.955f}, kNoEnds);
        }
        add_box(builder, iron, wall.frame, {x - 1.2f, y + 1.1f, 0.91f}, {x + 1.2f, y + 1.15f, 0.97f});
        for (const float s : {x - 1.2f, x + 1.17f}) add_box(builder, iron, wall.frame, {s, y + 1.1f, 0}, {s + 0.03f, y + 1.15f, 0.91f}, kNoEnds | kFaceTop | kFaceBottom);
      }
    }
  }
  add_box(builder, paint, wall.frame, {-0.12f, top - 0.28f, 0}, {wall.length + 0.12f, top - 0.12f, 0.14f}, kAllButBack);
  add_box(builder, paint, wall.frame, {-0.25f, top - 0.12f, 0}, {wall.length + 0.25f, top + 0.1f, 0.28f}, kAllButBack);
  if (wall.is_front) {
    add_box(builder, paint, wall.frame, {0, kGroundFloorHeight - 0.12f, 0}, {wall.length, kGroundFloorHeight + 0.06f, 0.12f}, kAllButBack);
    const float x = random.chance(0.5) ? 0.2f : wall.length - 0.2f;
    add_tube(builder, iron, wall.frame.point({x, 0.1f, 0.1f}), wall.frame.point({x, top, 0.1f}), 0.05f, 8);
  }
}

void add_flat_roof(ModelBuilder& builder, const CityPaints& paints, const Frame& frame, glm::vec2 size, float top,
                   const glm::u8vec4& trim, RandomStream& random) {
  add_quad(builder, paints.gravel, frame, {0, top, size.y}, {size.x, top, size.y}, {size.x, top, 0}, {0, top, 0});
  const Paint wall = paints.coloured(trim), metal = paints.coloured({168, 172, 176, 255}), dark = paints.coloured({66, 70, 74, 255});
  const float h = top + 0.6f, t = 0.25f;
  add_box(builder, wall, frame, {0, top, size.y - t}, {size.x, h, size.y}, kAllFaces & ~kFaceBottom);
  add_box(builder, wall, frame, {0, top, 0}, {size.x, h, t}, kAllFaces & ~kFaceBottom);
  add_box(builder, wall, frame, {0, top, t}, {t, h, size.y - t}, kFaceTop | kFaceLeft | kFaceRight);
  add_box(builder, wall, frame, {size.x - t, top, t}, {size.x, h, size.y - t}, kFaceTop | kFaceLeft | kFaceRight);
  const int units = 1 + static_cast<int>(size.x / 6);
  for (int k = 0; k < units; ++k) {
    const Frame at = frame.moved({(static_cast<float>(k) + 0.5f) * size.x / static_cast<float>(units), top, random.between(0.3f, 0.7f) * size.y});
    const float w = random.between(0.6f, 1.3f), height = random.between(0.9f, 1.7f);
    add_chamfered_box(builder, metal, at, {-w, 0.25f, -0.7f}, {w, height, 0.7f}, 0.04f);
    add_box(builder, dark, at, {-0.8f * w, 0, -0.5f}, {0.8f * w, 0.25f, 0.5f}, kNoEnds);
    const std::array<glm::vec2, 6> fan{{{0.45f, height}, {0.45f, height + 0.15f}, {0.40f, height + 0.15f}, {0.40f, height + 0.04f}, {0.1f, height + 0.04f}, {0, height + 0.1f}}};
    add_lathe(builder, dark, at, fan, 16);
  }
}

void add_chimney(ModelBuilder& builder, const CityPaints& paints, const Frame& at, float low, float high) {
  add_box(builder, paints.coloured({148, 84, 66, 255}), at, {-0.35f, low, -0.3f}, {0.35f, high, 0.3f}, kNoEnds | kFaceTop);
  add_box(builder, paints.coloured({120, 116, 110, 255}), at, {-0.42f, high, -0.37f}, {0.42f, high + 0.12f, 0.37f});
  for (const float x : {-0.17f, 0.17f}) {
    const std::array<glm::vec2, 4> pot{{{0.12f, high + 0.12f}, {0.10f, high + 0.55f}, {0.12f, high + 0.6f}, {0.08f, high + 0.6f}}};
    add_lathe(builder, paints.coloured({176, 96, 66, 255}), at.moved({x, 0, 0}), pot, 10);
  }
}

void add_pitched_roof(ModelBuilder& builder, const CityPaints& paints, const Paint& facade, const Frame& frame,
                      glm::vec2 size, float top, RandomStream& random) {
  const float eave = 0.45f, ridge = top + 0.42f * size.y, half = 0.5f * size.y;
  const float low = top - eave * (ridge - top) / half;
  const Paint& tiles = paints.roof_tiles;
  const bool is_hipped = random.chance(0.4) && size.x > size.y;
  const float inset = is_hipped ? half : -0.2f, out = is_hipped ? eave : 0.2f;
  add_quad(builder, tiles, frame, {-out, low, size.y + eave}, {size.x + out, low, size.y + eave}, {size.x - inset, ridge, half}, {inset, ridge, half});
  add_quad(builder, tiles, frame, {size.x + out, low, -eave}, {-out, low, -eave}, {inset, ridge, half}, {size.x - inset, ridge, half});
  if (is_hipped) {
    add_triangle(builder, tiles, frame, {size.x + out, low, size.y + eave}, {size.x + out, low, -eave}, {size.x - inset, ridge, half});
    add_triangle(builder, tiles, frame, {-out, low, -eave}, {-out, low, size.y + eave}, {inset, ridge, half});
  } else {
    const Paint gable{facade.material, facade.colour, 1.0f / 12};
    add_triangle(builder, gable, frame, {size.x, top, size.y}, {size.x, top, 0}, {size.x, ridge, half});
    add_triangle(builder, gable, frame, {0, top, 0}, {0, top, size.y}, {0, ridge, half});
  }
  const float slope = (ridge - top) / half;
  const int dormers = static_cast<int>(size.x / 5);
  for (int k = 0; k < dormers; ++k) {  // on the front slope
    const float x = (static_cast<float>(k) + 0.5f) * size.x / static_cast<float>(dormers), z = size.y - 1.4f;
    const float sill = top + 1.4f * slope - 0.1f, back = z - 1.3f / slope;
    const Frame at = frame.moved({x, 0, 0});
    add_box(builder, paints.coloured({214, 208, 196, 255}), at, {-0.7f, sill - 0.4f, back}, {0.7f, sill + 1.15f, z}, kFaceLeft | kFaceRight | kFaceFront);
    add_box(builder, paints.coloured({42, 52, 62, 255}), at, {-0.42f, sill + 0.15f, z}, {0.42f, sill + 1.0f, z + 0.02f}, kAllButBack);
    for (const float bar : {-0.45f, -0.02f, 0.41f}) add_box(builder, paints.coloured({240, 238, 232, 255}), at, {bar, sill + 0.12f, z}, {bar + 0.04f, sill + 1.03f, z + 0.05f}, kAllButBack);
    add_box(builder, paints.coloured({96, 100, 104, 255}), at, {-0.85f, sill + 1.15f, back}, {0.85f, sill + 1.25f, z + 0.2f});
  }
  add_chimney(builder, paints, frame.moved({random.between(0.25f, 0.75f) * size.x, 0, half + 0.8f}), ridge - 1.2f, ridge + 0.9f);
}

}  // namespace

void add_building(ModelBuilder& builder, const CityPaints& paints, const Frame& frame, glm::vec2 size_m, int floors,
                  RandomStream& random) {
  static constexpr std::array<glm::u8vec4, 4> kTrims{{{226, 220, 208, 255}, {204, 196, 182, 255}, {182, 178, 172, 255}, {236, 232, 224, 255}}};
  const Paint& facade = random.pick(paints.facades);
  const glm::u8vec4 trim = random.pick(kTrims);
  const bool has_shops = random.chance(0.5), has_balconies = random.chance(0.35);
  const float top = kGroundFloorHeight + kFloorHeight * static_cast<float>(floors - 1);
  for (const Wall& wall : walls_of(frame, size_m)) {
    add_facade(builder, paints, facade, wall, floors, has_shops, random);
    add_relief(builder, paints, wall, floors, trim, has_balconies && wall.is_front, random);
  }
  if (floors > 6 || random.chance(0.4)) {
    add_flat_roof(builder, paints, frame, size_m, top, trim, random);
  } else {
    add_pitched_roof(builder, paints, facade, frame, size_m, top, random);
  }
}

}  // namespace farfield
