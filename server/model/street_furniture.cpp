// SPDX-License-Identifier: Apache-2.0
#include "server/model/street_furniture.h"

#include <array>
#include <cmath>
#include <span>

namespace farfield {
namespace {

constexpr float kTau = 6.28318530718f;

Paint coloured(const Paint& plain, const glm::u8vec4& colour) { return {plain.material, colour, 0}; }

// A square card with its texture once, shaded as part of a round crown: all corners carry `normal`.
void add_card(ModelBuilder& builder, const Paint& paint, const glm::vec3& center, const glm::vec3& right,
              const glm::vec3& up, const glm::vec3& normal) {
  const std::uint32_t i = builder.vertex(paint.material, center - right - up, normal, {0, 1}, paint.colour);
  builder.vertex(paint.material, center + right - up, normal, {1, 1}, paint.colour);
  builder.vertex(paint.material, center + right + up, normal, {1, 0}, paint.colour);
  builder.vertex(paint.material, center - right + up, normal, {0, 0}, paint.colour);
  builder.triangle(paint.material, i, i + 1, i + 2);
  builder.triangle(paint.material, i, i + 2, i + 3);
}

glm::vec3 random_direction(RandomStream& random) {
  const float y = random.between(-1.0f, 1.0f), angle = random.between(0.0f, kTau), r = std::sqrt(1 - y * y);
  return {r * std::cos(angle), y, r * std::sin(angle)};
}

}  // namespace

void add_tree(ModelBuilder& builder, const Paint& bark, const Paint& leaves, const Frame& frame, float height_m,
              RandomStream& random) {
  const float trunk = 0.42f * height_m, girth = 0.022f * height_m + 0.04f;
  const std::array<glm::vec2, 5> profile{{{1.7f * girth, 0}, {1.1f * girth, 0.35f}, {girth, 1.0f}, {0.8f * girth, trunk}, {0.3f * girth, 0.75f * height_m}}};
  add_lathe(builder, bark, frame, profile, 10);
  const glm::vec3 radius{0.30f * height_m, 0.31f * height_m, 0.30f * height_m};
  const glm::vec3 middle = frame.point({0, 0.68f * height_m, 0});
  for (int k = 0; k < 7; ++k) {
    const float angle = kTau * (static_cast<float>(k) + random.between(-0.3f, 0.3f)) / 7, reach = random.between(0.55f, 0.85f);
    const glm::vec3 root = frame.point({0, trunk + 0.03f * height_m * static_cast<float>(k), 0});
    const glm::vec3 tip = middle + reach * radius * glm::vec3(std::cos(angle), random.between(-0.1f, 0.6f), std::sin(angle));
    add_tube(builder, bark, root, tip, 0.42f * girth, 6, 0.12f * girth);
  }
  const int cards = 90 + static_cast<int>(6 * height_m);
  for (int k = 0; k < cards; ++k) {
    const glm::vec3 out = random_direction(random);
    const glm::vec3 at = middle + radius * out * (0.45f + 0.55f * std::sqrt(random.between(0.0f, 1.0f)));
    const glm::vec3 facing = glm::normalize(out + 0.9f * random_direction(random));
    const Frame card = Frame::along(at, facing);
    const float half = random.between(0.085f, 0.13f) * height_m;
    const float shade = random.between(0.8f, 1.0f);
    Paint paint = leaves;
    paint.colour = glm::u8vec4(glm::vec3(leaves.colour) * shade, 255);
    add_card(builder, paint, at, half * card.axes[0], half * card.axes[2], glm::normalize(out + glm::vec3(0, 0.3f, 0)));
  }
}

void add_car(ModelBuilder& builder, const Paint& plain, const Frame& frame, RandomStream& random) {
  static constexpr std::array<glm::u8vec4, 8> kColours{{{176, 30, 34, 255}, {28, 60, 120, 255}, {222, 224, 226, 255}, {34, 36, 40, 255},
                                                        {130, 136, 142, 255}, {36, 92, 70, 255}, {196, 178, 140, 255}, {216, 150, 40, 255}}};
  const Paint body = coloured(plain, random.pick(kColours)), glass = coloured(plain, {36, 46, 56, 255});
  const Paint rubber = coloured(plain, {30, 30, 32, 255}), metal = coloured(plain, {190, 194, 198, 255});
  const float length = random.between(3.8f, 4.7f), half = 0.5f * length, w = 0.86f;
  add_chamfered_box(builder, body, frame, {-half, 0.30f, -w}, {half, 0.86f, w}, 0.14f);
  add_chamfered_box(builder, coloured(plain, {44, 46, 50, 255}), frame, {-0.96f * half, 0.2f, -0.94f * w}, {0.96f * half, 0.36f, 0.94f * w}, 0.05f);
  // Cabin: four leaning panes under a roof.
  const float front = 0.22f * length, back = -0.40f * length, roof_front = 0.06f * length, roof_back = -0.32f * length;
  const float low = 0.84f, high = 1.36f, narrow = 0.68f;
  const std::array<glm::vec3, 4> sill{{{front, low, w - 0.05f}, {front, low, 0.05f - w}, {back, low, 0.05f - w}, {back, low, w - 0.05f}}};
  const std::array<glm::vec3, 4> roof{{{roof_front, high, narrow}, {roof_front, high, -narrow}, {roof_back, high, -narrow}, {roof_back, high, narrow}}};
  for (std::size_t k = 0; k < 4; ++k) {
    const std::size_t n = (k + 1) % 4;
    add_quad(builder, glass, frame, sill[k], sill[n], roof[n], roof[k]);
    add_tube(builder, body, frame.point(sill[k]), frame.point(roof[k]), 0.045f, 6);
  }
  add_chamfered_box(builder, body, frame, {roof_back - 0.04f, high - 0.03f, -narrow - 0.03f}, {roof_front + 0.04f, high + 0.06f, narrow + 0.03f}, 0.04f);
  const float pillar = 0.5f * (roof_front + roof_back);
  for (const float side : {-1.0f, 1.0f}) {
    add_tube(builder, body, frame.point({pillar - 0.05f, low, side * (w - 0.04f)}), frame.point({pillar, high, side * narrow}), 0.04f, 6);
    for (const float x : {-0.32f * length, 0.31f * length}) {
      const std::array<glm::vec2, 9> wheel{{{0.0f, -0.09f}, {0.20f, -0.10f}, {0.30f, -0.10f}, {0.32f, -0.06f}, {0.32f, 0.07f}, {0.29f, 0.10f}, {0.21f, 0.10f}, {0.19f, 0.06f}, {0.0f, 0.08f}}};
      const Frame hub = Frame::along(frame.point({x, 0.32f, side * (w - 0.08f)}), side * frame.axes[2]);
      add_lathe(builder, rubber, hub, std::span(wheel).first(7), 20);
      add_lathe(builder, metal, hub, std::span(wheel).subspan(6), 20);
    }
    add_chamfered_box(builder, coloured(plain, {250, 246, 224, 255}), frame, {half - 0.06f, 0.55f, side * 0.6f - 0.16f}, {half + 0.015f, 0.70f, side * 0.6f + 0.16f}, 0.03f);
    add_chamfered_box(builder, coloured(plain, {170, 20, 22, 255}), frame, {-half - 0.015f, 0.58f, side * 0.62f - 0.14f}, {-half + 0.06f, 0.72f, side * 0.62f + 0.14f}, 0.03f);
    add_chamfered_box(builder, body, frame, {0.17f * length, 0.86f, side * (w + 0.08f) - 0.08f}, {0.20f * length, 1.0f, side * (w + 0.08f) + 0.08f}, 0.03f);
  }
  add_chamfered_box(builder, metal, frame, {half - 0.02f, 0.40f, -0.28f}, {half + 0.02f, 0.50f, 0.28f}, 0.01f);
}

void add_street_lamp(ModelBuilder& builder, const Paint& plain, const Frame& frame) {
  const Paint iron = coloured(plain, {62, 68, 72, 255});
  const std::array<glm::vec2, 8> post{{{0.16f, 0}, {0.16f, 0.12f}, {0.11f, 0.18f}, {0.10f, 0.9f}, {0.075f, 1.0f}, {0.05f, 5.4f}, {0.04f, 5.6f}, {0, 5.62f}}};
  add_lathe(builder, iron, frame, post, 12);
  glm::vec3 before = frame.point({0, 5.3f, 0});
  for (int k = 1; k <= 5; ++k) {
    const float angle = 0.25f * kTau * static_cast<float>(k) / 5;
    const glm::vec3 here = frame.point({1.3f * (1 - std::cos(angle)), 5.3f + 0.7f * std::sin(angle), 0});
    add_tube(builder, iron, before, here, 0.035f, 8);
    before = here;
  }
  add_chamfered_box(builder, iron, frame, {1.1f, 5.95f, -0.14f}, {1.75f, 6.08f, 0.14f}, 0.05f);
  add_box(builder, coloured(plain, {255, 248, 220, 255}), frame, {1.2f, 5.93f, -0.1f}, {1.7f, 5.95f, 0.1f}, kAllFaces & ~kFaceTop);
}

void add_bench(ModelBuilder& builder, const Paint& plain, const Frame& frame) {
  const Paint wood = coloured(plain, {140, 98, 60, 255}), iron = coloured(plain, {46, 50, 52, 255});
  for (int k = 0; k < 4; ++k) {
    const float z = -0.18f + 0.12f * static_cast<float>(k), y = 0.52f + 0.12f * static_cast<float>(k);
    add_chamfered_box(builder, wood, frame, {-0.9f, 0.43f, z}, {0.9f, 0.47f, z + 0.09f}, 0.01f);
    if (k < 3) add_chamfered_box(builder, wood, frame, {-0.9f, y, -0.25f - 0.03f * static_cast<float>(k)}, {0.9f, y + 0.09f, -0.22f - 0.03f * static_cast<float>(k)}, 0.01f);
  }
  for (const float x : {-0.7f, 0.7f}) {
    for (const float z : {-0.2f, 0.2f}) add_tube(builder, iron, frame.point({x, 0, z}), frame.point({x, 0.43f, z}), 0.025f, 8);
    add_tube(builder, iron, frame.point({x, 0.43f, -0.2f}), frame.point({x, 0.92f, -0.31f}), 0.025f, 8);
    add_tube(builder, iron, frame.point({x, 0.42f, -0.2f}), frame.point({x, 0.42f, 0.2f}), 0.02f, 8);
  }
}

}  // namespace farfield
