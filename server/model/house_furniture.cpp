// SPDX-License-Identifier: Apache-2.0
#include "server/model/house_furniture.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace farfield {
namespace {

constexpr glm::u8vec4 kWhite{238, 236, 230, 255}, kDark{48, 50, 54, 255}, kMetal{176, 178, 182, 255};
constexpr float kTau = 6.28318530718f;

void box(ModelBuilder& b, const Paint& paint, const Frame& frame, const glm::vec3& low, const glm::vec3& high, float chamfer = 0.008f) {
  add_chamfered_box(b, paint, frame, low, high, chamfer);
}

}  // namespace

void add_table(ModelBuilder& b, const Paint& wood, const Frame& frame, glm::vec3 size) {
  const float x = 0.5f * size.x, z = 0.5f * size.z;
  box(b, wood, frame, {-x, size.y - 0.035f, -z}, {x, size.y, z});
  for (const float side : {-1.0f, 1.0f}) {
    box(b, wood, frame, {-x + 0.08f, size.y - 0.11f, side * (z - 0.09f) - 0.01f}, {x - 0.08f, size.y - 0.035f, side * (z - 0.09f) + 0.01f}, 0.004f);
    box(b, wood, frame, {side * (x - 0.09f) - 0.01f, size.y - 0.11f, -z + 0.08f}, {side * (x - 0.09f) + 0.01f, size.y - 0.035f, z - 0.08f}, 0.004f);
    for (const float end : {-1.0f, 1.0f}) {
      const std::array<glm::vec2, 8> leg{{{0.018f, 0}, {0.026f, 0.04f}, {0.02f, 0.1f}, {0.026f, 0.4f * size.y}, {0.034f, 0.7f * size.y}, {0.026f, 0.74f * size.y}, {0.036f, 0.78f * size.y}, {0.036f, size.y - 0.035f}}};
      add_lathe(b, wood, frame.moved({side * (x - 0.08f), 0, end * (z - 0.08f)}), leg, 12);
    }
  }
}

void add_chair(ModelBuilder& b, const Paint& wood, const Paint& seat, const Frame& frame) {
  box(b, wood, frame, {-0.21f, 0.42f, -0.2f}, {0.21f, 0.45f, 0.21f});
  box(b, seat, frame, {-0.19f, 0.45f, -0.17f}, {0.19f, 0.485f, 0.2f}, 0.016f);
  for (const float x : {-0.185f, 0.185f}) {
    add_tube(b, wood, frame.point({x, 0, 0.18f}), frame.point({x, 0.42f, 0.18f}), 0.014f, 10, 0.02f);
    add_tube(b, wood, frame.point({x, 0, -0.22f}), frame.point({x, 0.45f, -0.18f}), 0.014f, 10, 0.018f);
    add_tube(b, wood, frame.point({x, 0.45f, -0.18f}), frame.point({x, 0.92f, -0.25f}), 0.018f, 10, 0.014f);
    add_tube(b, wood, frame.point({x, 0.2f, -0.2f}), frame.point({x, 0.2f, 0.18f}), 0.01f, 8);
  }
  for (int k = 0; k < 4; ++k) {
    const float x = -0.12f + 0.08f * static_cast<float>(k);
    add_tube(b, wood, frame.point({x, 0.45f, -0.185f}), frame.point({x, 0.86f, -0.24f}), 0.008f, 8);
  }
  box(b, wood, frame, {-0.2f, 0.85f, -0.262f}, {0.2f, 0.94f, -0.238f});
}

void add_bookshelf(ModelBuilder& b, const HousePaints& paints, const Frame& frame, float width, RandomStream& random) {
  static constexpr std::array<glm::u8vec4, 9> kSpines{{{142, 38, 36, 255}, {36, 66, 110, 255}, {40, 92, 62, 255}, {196, 160, 84, 255}, {82, 54, 96, 255}, {220, 212, 192, 255}, {44, 46, 50, 255}, {176, 96, 48, 255}, {108, 132, 140, 255}}};
  constexpr float kHeight = 2.05f, kDepth = 0.3f, kBoard = 0.022f;
  const float half = 0.5f * width;
  for (const float x : {-half, half - kBoard}) box(b, paints.wood, frame, {x, 0, 0.01f}, {x + kBoard, kHeight, kDepth}, 0.004f);
  add_box(b, paints.wood, frame, {-half, 0, 0.004f}, {half, kHeight, 0.01f}, kFaceFront | kFaceBack);
  for (int shelf = 0; shelf <= 6; ++shelf) {
    const float y = 0.06f + (kHeight - 0.06f - kBoard) * static_cast<float>(shelf) / 6;
    box(b, paints.wood, frame, {-half + kBoard, y, 0.01f}, {half - kBoard, y + kBoard, kDepth - 0.01f}, 0.004f);
    if (shelf == 6) break;
    for (float x = -half + kBoard + 0.005f; x < half - kBoard - 0.06f;) {
      const float thick = random.between(0.018f, 0.048f);
      if (random.chance(0.06)) {  // a gap between books
        x += random.between(0.05f, 0.16f);
        continue;
      }
      const float height = random.between(0.19f, 0.285f), depth = random.between(0.15f, 0.22f);
      box(b, paints.coloured(random.pick(kSpines)), frame, {x, y + kBoard, 0.04f}, {x + thick, y + kBoard + height, 0.04f + depth}, 0.005f);
      x += thick + 0.0015f;
    }
  }
}

void add_sofa(ModelBuilder& b, const Paint& cloth, const Frame& frame, float width) {
  const float half = 0.5f * width;
  box(b, cloth, frame, {-half, 0.1f, 0.04f}, {half, 0.3f, 0.86f}, 0.04f);
  box(b, cloth, frame, {-half, 0.3f, 0.02f}, {half, 0.84f, 0.24f}, 0.08f);
  for (const float x : {-half, half - 0.18f}) box(b, cloth, frame, {x, 0.28f, 0.06f}, {x + 0.18f, 0.62f, 0.88f}, 0.07f);
  const int seats = width > 1.7f ? 3 : 2;
  const float pitch = (width - 0.38f) / static_cast<float>(seats);
  for (int k = 0; k < seats; ++k) {
    const float x = -half + 0.19f + pitch * static_cast<float>(k);
    box(b, cloth, frame, {x + 0.005f, 0.29f, 0.2f}, {x + pitch - 0.005f, 0.46f, 0.9f}, 0.05f);
    box(b, cloth, frame, {x + 0.02f, 0.44f, 0.2f}, {x + pitch - 0.02f, 0.88f, 0.38f}, 0.07f);
  }
  for (const float x : {-half + 0.1f, half - 0.1f}) {
    for (const float z : {0.12f, 0.78f}) add_tube(b, {cloth.material, kDark, 0}, frame.point({x, 0, z}), frame.point({x, 0.12f, z}), 0.02f, 8, 0.028f);
  }
}

void add_bed(ModelBuilder& b, const HousePaints& paints, const Frame& frame, RandomStream& random) {
  static constexpr std::array<glm::u8vec4, 4> kCovers{{{150, 60, 56, 255}, {70, 96, 130, 255}, {108, 124, 88, 255}, {196, 178, 146, 255}}};
  box(b, paints.dark_wood, frame, {-0.85f, 0.12f, 0.05f}, {0.85f, 0.32f, 2.05f}, 0.015f);
  box(b, paints.dark_wood, frame, {-0.88f, 0.0f, 0.01f}, {0.88f, 1.05f, 0.06f}, 0.015f);
  for (const float x : {-0.8f, 0.74f}) {
    for (const float z : {0.1f, 1.95f}) box(b, paints.dark_wood, frame, {x, 0, z}, {x + 0.06f, 0.13f, z + 0.06f});
  }
  box(b, paints.coloured(kWhite), frame, {-0.81f, 0.32f, 0.08f}, {0.81f, 0.52f, 2.02f}, 0.06f);
  Paint cover = paints.fabric;
  cover.colour = random.pick(kCovers);
  box(b, cover, frame, {-0.86f, 0.30f, 0.72f}, {0.86f, 0.57f, 2.07f}, 0.07f);
  for (const float x : {-0.72f, 0.08f}) box(b, paints.coloured(kWhite), frame, {x, 0.5f, 0.14f}, {x + 0.64f, 0.66f, 0.56f}, 0.075f);
  for (const float x : {-1.4f, 0.95f}) {
    const Frame at = frame.moved({x, 0, 0.02f});
    box(b, paints.dark_wood, at, {0, 0.05f, 0}, {0.45f, 0.5f, 0.4f});
    for (const float y : {0.1f, 0.3f}) {
      box(b, paints.dark_wood, at, {0.02f, y, 0.4f}, {0.43f, y + 0.17f, 0.418f}, 0.005f);
      box(b, paints.coloured(kMetal), at, {0.19f, y + 0.08f, 0.418f}, {0.26f, y + 0.095f, 0.438f}, 0.004f);
    }
    const std::array<glm::vec2, 9> lamp{{{0, 0.5f}, {0.07f, 0.5f}, {0.07f, 0.52f}, {0.015f, 0.54f}, {0.03f, 0.62f}, {0.012f, 0.7f}, {0.012f, 0.74f}, {0.13f, 0.74f}, {0.08f, 0.92f}}};
    add_lathe(b, paints.coloured({226, 206, 168, 255}), at.moved({0.22f, 0, 0.2f}), lamp, 20);
  }
}

void add_wardrobe(ModelBuilder& b, const HousePaints& paints, const Frame& frame, float width) {
  const int doors = std::max(2, static_cast<int>(width / 0.55f));
  const float half = 0.5f * width, pitch = width / static_cast<float>(doors);
  box(b, paints.dark_wood, frame, {-half, 0, 0.01f}, {half, 2.2f, 0.58f});
  box(b, paints.dark_wood, frame, {-half - 0.03f, 2.2f, 0}, {half + 0.03f, 2.26f, 0.63f}, 0.02f);
  for (int k = 0; k < doors; ++k) {
    const float x = -half + pitch * static_cast<float>(k);
    box(b, paints.wood, frame, {x + 0.008f, 0.1f, 0.58f}, {x + pitch - 0.008f, 2.18f, 0.60f}, 0.006f);
    for (const float y : {0.2f, 1.2f}) box(b, paints.wood, frame, {x + 0.08f, y, 0.60f}, {x + pitch - 0.08f, y + (y < 1 ? 0.9f : 0.88f), 0.612f}, 0.012f);
    const float knob = k % 2 == 0 ? x + pitch - 0.05f : x + 0.05f;
    const std::array<glm::vec2, 5> handle{{{0.008f, 0}, {0.008f, 0.015f}, {0.02f, 0.025f}, {0.015f, 0.04f}, {0, 0.042f}}};
    add_lathe(b, paints.coloured(kMetal), Frame::along(frame.point({knob, 1.12f, 0.60f}), frame.axes[2]), handle, 14);
  }
}

void add_kitchen(ModelBuilder& b, const HousePaints& paints, const Frame& frame, float width) {
  const Paint front = paints.coloured({206, 214, 210, 255}), metal = paints.coloured(kMetal), dark = paints.coloured(kDark);
  const int units = std::max(3, static_cast<int>(width / 0.6f));
  const float pitch = width / static_cast<float>(units), half = 0.5f * width;
  add_box(b, dark, frame, {-half, 0, 0.02f}, {half, 0.1f, 0.52f}, kNoEnds);
  box(b, paints.concrete, frame, {-half - 0.01f, 0.86f, 0.01f}, {half + 0.01f, 0.9f, 0.63f});
  for (int k = 0; k < units; ++k) {
    const float x = -half + pitch * static_cast<float>(k);
    add_box(b, front, frame, {x, 0.1f, 0.02f}, {x + pitch, 0.86f, 0.58f}, kNoEnds);
    const float split = k % 2 == 0 ? 0.66f : 0.12f;
    box(b, front, frame, {x + 0.004f, 0.11f, 0.58f}, {x + pitch - 0.004f, split - 0.006f > 0.2f ? split - 0.006f : 0.855f, 0.6f}, 0.005f);
    if (split > 0.2f) box(b, front, frame, {x + 0.004f, split, 0.58f}, {x + pitch - 0.004f, 0.855f, 0.6f}, 0.005f);
    box(b, metal, frame, {x + 0.15f, 0.80f, 0.615f}, {x + pitch - 0.15f, 0.815f, 0.63f}, 0.005f);
    for (const float s : {x + 0.16f, x + pitch - 0.17f}) add_box(b, metal, frame, {s, 0.80f, 0.6f}, {s + 0.01f, 0.815f, 0.615f}, kAllFaces & ~(kFaceFront | kFaceBack));
    box(b, front, frame, {x + 0.003f, 1.45f, 0.01f}, {x + pitch - 0.003f, 2.15f, 0.35f}, 0.006f);
    box(b, metal, frame, {x + 0.2f, 1.48f, 0.35f}, {x + pitch - 0.2f, 1.495f, 0.375f}, 0.005f);
  }
  for (const glm::vec2 at : {glm::vec2(-0.12f, 0.2f), {0.12f, 0.2f}, {-0.12f, 0.42f}, {0.12f, 0.42f}}) {
    const std::array<glm::vec2, 5> hob{{{0.085f, 0.9f}, {0.085f, 0.91f}, {0.06f, 0.915f}, {0.055f, 0.906f}, {0, 0.906f}}};
    add_lathe(b, dark, frame.moved({-0.25f * width + at.x, 0, at.y}), hob, 24);
  }
  const std::array<glm::vec2, 7> pan{{{0, 0.915f}, {0.1f, 0.915f}, {0.115f, 0.93f}, {0.12f, 1.03f}, {0.128f, 1.035f}, {0.11f, 1.03f}, {0.1f, 0.93f}}};
  add_lathe(b, metal, frame.moved({-0.25f * width - 0.12f, 0, 0.2f}), pan, 28);
  const Frame sink = frame.moved({0.25f * width, 0, 0});
  box(b, metal, sink, {-0.28f, 0.895f, 0.12f}, {0.28f, 0.912f, 0.52f}, 0.006f);
  add_box(b, dark, sink, {-0.23f, 0.9121f, 0.18f}, {0.23f, 0.914f, 0.47f}, kFaceTop);
  add_tube(b, metal, sink.point({0, 0.9f, 0.13f}), sink.point({0, 1.15f, 0.13f}), 0.014f, 12);
  add_tube(b, metal, sink.point({0, 1.15f, 0.13f}), sink.point({0, 1.18f, 0.3f}), 0.012f, 12);
}

void add_desk(ModelBuilder& b, const HousePaints& paints, const Frame& frame) {
  box(b, paints.wood, frame, {-0.8f, 0.71f, 0.02f}, {0.8f, 0.74f, 0.78f});
  box(b, paints.coloured(kMetal), frame, {-0.78f, 0, 0.08f}, {-0.74f, 0.71f, 0.7f});
  box(b, paints.wood, frame, {0.35f, 0.04f, 0.08f}, {0.77f, 0.70f, 0.7f});
  for (int k = 0; k < 3; ++k) {
    const float y = 0.07f + 0.21f * static_cast<float>(k);
    box(b, paints.dark_wood, frame, {0.36f, y, 0.7f}, {0.76f, y + 0.2f, 0.715f}, 0.005f);
    box(b, paints.coloured(kMetal), frame, {0.5f, y + 0.15f, 0.715f}, {0.62f, y + 0.165f, 0.735f}, 0.004f);
  }
  const Paint dark = paints.coloured(kDark);
  box(b, dark, frame, {-0.3f, 0.84f, 0.24f}, {0.28f, 1.18f, 0.27f}, 0.006f);
  add_box(b, paints.coloured({120, 160, 190, 255}), frame, {-0.285f, 0.855f, 0.27f}, {0.265f, 1.165f, 0.2705f}, kFaceFront);
  box(b, dark, frame, {-0.04f, 0.74f, 0.2f}, {0.02f, 0.9f, 0.24f});
  box(b, dark, frame, {-0.14f, 0.74f, 0.14f}, {0.12f, 0.752f, 0.32f}, 0.004f);
  box(b, dark, frame, {-0.24f, 0.74f, 0.42f}, {0.2f, 0.755f, 0.56f}, 0.004f);
  for (int row = 0; row < 4; ++row) {
    for (int key = 0; key < 14; ++key) {
      const float x = -0.23f + 0.03f * static_cast<float>(key), z = 0.43f + 0.031f * static_cast<float>(row);
      add_box(b, paints.coloured({88, 92, 98, 255}), frame, {x, 0.755f, z}, {x + 0.024f, 0.761f, z + 0.025f}, kAllFaces & ~kFaceBottom);
    }
  }
  box(b, paints.coloured(kWhite), frame, {-0.72f, 0.74f, 0.35f}, {-0.45f, 0.765f, 0.7f}, 0.003f);
}

void add_floor_lamp(ModelBuilder& b, const HousePaints& paints, const Frame& frame) {
  const std::array<glm::vec2, 7> stand{{{0, 0}, {0.15f, 0}, {0.15f, 0.02f}, {0.03f, 0.05f}, {0.012f, 0.1f}, {0.012f, 1.5f}, {0, 1.5f}}};
  add_lathe(b, paints.coloured(kDark), frame, stand, 24);
  const std::array<glm::vec2, 3> shade{{{0.24f, 1.38f}, {0.2f, 1.55f}, {0.14f, 1.72f}}};
  add_lathe(b, paints.coloured({240, 222, 184, 255}), frame, shade, 32);
}

void add_ceiling_lamp(ModelBuilder& b, const HousePaints& paints, const Frame& frame) {
  const std::array<glm::vec2, 8> profile{{{0, -0.62f}, {0.12f, -0.60f}, {0.2f, -0.54f}, {0.22f, -0.46f}, {0.03f, -0.4f}, {0.01f, -0.38f}, {0.01f, -0.03f}, {0.06f, 0}}};
  add_lathe(b, paints.coloured({250, 240, 214, 255}), frame, profile, 28);
}

void add_radiator(ModelBuilder& b, const HousePaints& paints, const Frame& frame, float width) {
  const int ribs = static_cast<int>(width / 0.06f);
  for (int k = 0; k < ribs; ++k) {
    const float x = -0.5f * width + 0.06f * static_cast<float>(k);
    box(b, paints.coloured(kWhite), frame, {x, 0.12f, 0.04f}, {x + 0.045f, 0.7f, 0.14f}, 0.018f);
  }
  for (const float y : {0.18f, 0.64f}) add_tube(b, paints.coloured(kWhite), frame.point({-0.5f * width, y, 0.09f}), frame.point({0.5f * width + 0.05f, y, 0.09f}), 0.018f, 10);
}

void add_curtain(ModelBuilder& b, const Paint& cloth, const Frame& frame, float width, float height) {
  constexpr int kColumns = 48;
  std::uint32_t first = 0;
  for (int k = 0; k <= kColumns; ++k) {
    const float t = static_cast<float>(k) / kColumns, phase = kTau * 6 * t;
    for (int row = 0; row <= 4; ++row) {
      const float s = static_cast<float>(row) / 4, depth = 0.035f * (1.1f - 0.5f * s);
      const float slope = depth * kTau * 6 / width * std::cos(phase);
      const std::uint32_t i = b.vertex(cloth.material, frame.point({(t - 0.5f) * width, s * height, 0.06f + depth * std::sin(phase)}),
                                       frame.axes * glm::normalize(glm::vec3(-slope, 0, 1)), cloth.repeats_per_m * glm::vec2(1.6f * t * width, -s * height), cloth.colour);
      if (k == 0 && row == 0) first = i;
    }
  }
  for (std::uint32_t k = 0; k < kColumns; ++k) {
    for (std::uint32_t row = 0; row < 4; ++row) {
      const std::uint32_t i = first + 5 * k + row;
      b.triangle(cloth.material, i, i + 5, i + 6);
      b.triangle(cloth.material, i, i + 6, i + 1);
    }
  }
}

void add_picture(ModelBuilder& b, const HousePaints& paints, const Frame& frame, RandomStream& random) {
  const float w = random.between(0.25f, 0.5f), h = random.between(0.2f, 0.38f);
  for (const float y : {-h, h - 0.04f}) box(b, paints.dark_wood, frame, {-w, y, 0.002f}, {w, y + 0.04f, 0.035f}, 0.01f);
  for (const float x : {-w, w - 0.04f}) box(b, paints.dark_wood, frame, {x, -h + 0.04f, 0.002f}, {x + 0.04f, h - 0.04f, 0.035f}, 0.01f);
  const Paint sky = paints.coloured({168, 196, 214, 255}), land = paints.coloured({static_cast<std::uint8_t>(90 + random.below(90)), 128, 82, 255});
  const float horizon = random.between(-0.3f, 0.2f) * h;
  add_quad(b, sky, frame, {-w, horizon, 0.012f}, {w, horizon, 0.012f}, {w, h, 0.012f}, {-w, h, 0.012f});
  add_quad(b, land, frame, {-w, -h, 0.012f}, {w, -h, 0.012f}, {w, horizon, 0.012f}, {-w, horizon, 0.012f});
  for (int k = 0; k < 4; ++k) {  // hills
    const float x = random.between(-0.7f, 0.4f) * w, size = random.between(0.15f, 0.3f) * w;
    add_triangle(b, paints.coloured({96, 110, 128, 255}), frame, {x, horizon, 0.013f + 0.0005f * static_cast<float>(k)}, {x + size, horizon, 0.013f + 0.0005f * static_cast<float>(k)},
                 {x + 0.5f * size, horizon + 0.5f * size, 0.013f + 0.0005f * static_cast<float>(k)});
  }
}

void add_pot_plant(ModelBuilder& b, const HousePaints& paints, const Frame& frame, RandomStream& random) {
  const std::array<glm::vec2, 8> pot{{{0, 0}, {0.13f, 0}, {0.18f, 0.26f}, {0.2f, 0.27f}, {0.2f, 0.32f}, {0.17f, 0.32f}, {0.16f, 0.28f}, {0, 0.28f}}};
  add_lathe(b, paints.coloured({168, 92, 62, 255}), frame, pot, 24);
  for (int k = 0; k < 26; ++k) {
    const float angle = random.between(0.0f, kTau), reach = random.between(0.12f, 0.32f), top = random.between(0.5f, 1.15f);
    const glm::vec3 tip{reach * std::cos(angle), top, reach * std::sin(angle)};
    add_tube(b, paints.coloured({72, 96, 48, 255}), frame.point({0.2f * tip.x, 0.28f, 0.2f * tip.z}), frame.point(tip), 0.008f, 5, 0.004f);
    const glm::vec3 out = glm::normalize(glm::vec3(std::cos(angle), 0.6f, std::sin(angle)));
    const Frame leaf = Frame::along(frame.point(tip), frame.axes * out);
    const float size = random.between(0.09f, 0.15f);
    add_quad(b, paints.leaves, leaf, {-size, 0, size}, {size, 0, size}, {size, 0, -size}, {-size, 0, -size}, {0, 1}, {1, 0});
  }
}

}  // namespace farfield
