// SPDX-License-Identifier: Apache-2.0
#include "server/model/plant_equipment.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace farfield {
namespace {

constexpr glm::u8vec4 kBareSteel{150, 155, 160, 255};
constexpr glm::u8vec4 kDarkSteel{88, 94, 102, 255};
constexpr glm::u8vec4 kSafetyYellow{232, 184, 36, 255};
constexpr float kQuarterTurn = 1.57079632679f;

int sides_for(float radius_m) { return radius_m < 0.06f ? 12 : radius_m < 0.2f ? 14 : 18; }

// A dome of `depth` metres above a cylinder of `radius`, as lathe points from rim to pole.
void append_dome(std::vector<glm::vec2>& profile, float radius, float base, float depth, int steps) {
  for (int k = 1; k <= steps; ++k) {
    const float angle = kQuarterTurn * static_cast<float>(k) / static_cast<float>(steps);
    profile.emplace_back(k == steps ? 0.0f : radius * std::cos(angle), base + depth * std::sin(angle));
  }
}

std::vector<glm::vec2> capsule(float radius, float bottom, float top, float depth, int steps) {
  std::vector<glm::vec2> profile;
  append_dome(profile, radius, 0, -1, steps);  // the pole first, then the rim
  std::reverse(profile.begin(), profile.end());
  for (glm::vec2& p : profile) p.y = bottom + depth * p.y;
  profile.emplace_back(radius, bottom);
  profile.emplace_back(radius, top);
  append_dome(profile, radius, top, depth, steps);
  return profile;
}

}  // namespace

glm::u8vec4 pipe_colour(RandomStream& random) {
  static constexpr std::array<glm::u8vec4, 9> kColours{{{178, 184, 190, 255}, {178, 184, 190, 255}, {72, 120, 84, 255},
                                                        {60, 96, 150, 255},   {196, 150, 48, 255},  {168, 64, 52, 255},
                                                        {130, 96, 70, 255},   {214, 210, 200, 255}, {108, 116, 124, 255}}};
  return random.pick(kColours);
}

void add_flange(ModelBuilder& builder, const Paint& paint, const glm::vec3& center, const glm::vec3& axis,
                float radius_m) {
  const float outer = 1.55f * radius_m + 0.02f, half = 0.16f * radius_m + 0.012f;
  const std::array<glm::vec2, 4> profile{{{radius_m, -half}, {outer, -half}, {outer, half}, {radius_m, half}}};
  add_lathe(builder, paint, Frame::along(center, axis), profile, sides_for(radius_m));
}

void add_pipe_route(ModelBuilder& builder, const Paint& paint, const std::vector<glm::vec3>& points, float radius_m,
                    bool has_flanges) {
  const int sides = sides_for(radius_m);
  const float bend = 2.6f * radius_m;
  glm::vec3 from = points.front();
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {
    const glm::vec3 along = glm::normalize(points[i + 1] - points[i]);
    const bool is_last = i + 2 == points.size();
    const glm::vec3 to = is_last ? points[i + 1] : points[i + 1] - bend * along;
    add_tube(builder, paint, from, to, radius_m, sides);
    if (has_flanges) {
      if (i == 0) add_flange(builder, paint, from + 0.1f * along, along, radius_m);
      if (is_last || i % 2 == 1) add_flange(builder, paint, is_last ? to - 0.1f * along : to, along, radius_m);
    }
    if (is_last) break;
    const glm::vec3 next = glm::normalize(points[i + 2] - points[i + 1]);
    add_bend(builder, paint, points[i + 1], along, next, bend, radius_m, sides, radius_m < 0.06f ? 3 : 4);
    from = points[i + 1] + bend * next;
  }
}

void add_valve(ModelBuilder& builder, const PlantPaints& paints, const glm::vec3& center, const glm::vec3& axis,
               float radius_m) {
  const Paint body = paints.coloured({70, 86, 120, 255}), wheel = paints.coloured({176, 40, 36, 255});
  const float r = radius_m;
  const std::array<glm::vec2, 6> barrel{{{r, -2.4f * r}, {1.5f * r, -1.2f * r}, {1.8f * r, -0.4f * r}, {1.8f * r, 0.4f * r},
                                         {1.5f * r, 1.2f * r}, {r, 2.4f * r}}};
  add_lathe(builder, body, Frame::along(center, axis), barrel, 14);
  add_flange(builder, body, center - 2.4f * r * axis, axis, r);
  add_flange(builder, body, center + 2.4f * r * axis, axis, r);
  const std::array<glm::vec2, 7> bonnet{{{1.1f * r, 1.5f * r}, {1.1f * r, 2.4f * r}, {1.4f * r, 2.4f * r}, {1.4f * r, 2.8f * r},
                                         {0.5f * r, 3.2f * r}, {0.2f * r, 3.2f * r}, {0.2f * r, 5.2f * r}}};
  add_lathe(builder, body, Frame::at(center), bonnet, 10);
  const Frame top = Frame::at(center + glm::vec3(0, 5.0f * r, 0));
  add_torus(builder, wheel, top, 1.8f * r, 0.18f * r, 16, 5);
  for (int k = 0; k < 3; ++k) {
    const float angle = 2.0f * kQuarterTurn * static_cast<float>(k) / 3;
    const glm::vec3 spoke = 1.8f * r * glm::vec3(std::cos(angle), 0, std::sin(angle));
    add_tube(builder, wheel, top.origin - spoke, top.origin + spoke, 0.12f * r, 4);
  }
}

void add_vertical_vessel(ModelBuilder& builder, const PlantPaints& paints, const Frame& frame, float radius_m,
                         float height_m, RandomStream& random) {
  const Paint shell = paints.coloured(random.chance(0.6) ? glm::u8vec4(206, 210, 212, 255) : pipe_colour(random));
  const float skirt = 0.8f, dome = 0.5f * radius_m;
  const int sides = radius_m < 2 ? 30 : 40;
  const std::vector<glm::vec2> profile = capsule(radius_m, skirt + dome, height_m - dome, dome, 5);
  add_lathe(builder, shell, frame, profile, sides);
  const std::array<glm::vec2, 4> support{{{1.06f * radius_m, 0}, {1.06f * radius_m, 0.08f}, {0.98f * radius_m, 0.1f},
                                          {0.98f * radius_m, skirt + dome}}};
  add_lathe(builder, paints.coloured(kDarkSteel), frame, support, sides);
  for (float y = skirt + dome + 0.6f; y < height_m - dome; y += 2.5f) {  // stiffening rings
    const std::array<glm::vec2, 4> ring{{{radius_m, y}, {radius_m + 0.05f, y}, {radius_m + 0.05f, y + 0.06f}, {radius_m, y + 0.06f}}};
    add_lathe(builder, shell, frame, ring, sides);
  }
  const int nozzles = 2 + static_cast<int>(height_m / 3);
  for (int k = 0; k < nozzles; ++k) {
    const float angle = random.between(0.0f, 4 * kQuarterTurn), size = random.between(0.08f, 0.28f);
    const float y = random.between(skirt + dome + 0.3f, height_m - dome - 0.2f);
    const glm::vec3 out = frame.axes * glm::vec3(std::cos(angle), 0, std::sin(angle));
    const glm::vec3 root = frame.origin + 0.95f * radius_m * out + glm::vec3(0, y, 0);
    const glm::vec3 tip = root + (0.05f * radius_m + 0.3f) * out;
    add_tube(builder, shell, root, tip, size, 14);
    const std::array<glm::vec2, 5> cover{{{size, -0.04f}, {size + 0.07f, -0.04f}, {size + 0.07f, 0.04f}, {0.9f * size, 0.05f}, {0, 0.05f}}};
    add_lathe(builder, paints.coloured(kBareSteel), Frame::along(tip, out), cover, 14);
  }
}

void add_drum(ModelBuilder& builder, const PlantPaints& paints, const Frame& frame, float radius_m, float length_m,
              RandomStream& random) {
  const Paint shell = paints.coloured(pipe_colour(random)), support = paints.concrete;
  const float height = radius_m + 0.9f, dome = 0.45f * radius_m;
  const Frame axis{frame.point({0, height, 0}), frame.axes * glm::mat3(glm::vec3(0, -1, 0), glm::vec3(1, 0, 0), glm::vec3(0, 0, 1))};
  add_lathe(builder, shell, axis, capsule(radius_m, -0.5f * length_m + dome, 0.5f * length_m - dome, dome, 5), 28);
  for (const float x : {-0.3f * length_m, 0.3f * length_m}) {
    add_box(builder, support, frame, {x - 0.2f, 0, -0.8f * radius_m}, {x + 0.2f, height - 0.7f * radius_m, 0.8f * radius_m},
            kAllFaces & ~kFaceBottom);
    const std::array<glm::vec2, 4> band{{{radius_m, x - 0.15f}, {radius_m + 0.03f, x - 0.15f}, {radius_m + 0.03f, x + 0.15f}, {radius_m, x + 0.15f}}};
    add_lathe(builder, paints.coloured(kDarkSteel), axis, band, 28);
  }
  const std::array<glm::vec2, 6> manhole{{{0.3f, 0}, {0.3f, 0.25f}, {0.38f, 0.25f}, {0.38f, 0.33f}, {0.3f, 0.36f}, {0, 0.36f}}};
  add_lathe(builder, paints.coloured(kBareSteel), frame.moved({0, height + radius_m - 0.06f, 0}), manhole, 18);
  const float rise = height + radius_m;
  add_pipe_route(builder, paints.coloured(pipe_colour(random)),
                 {frame.point({0.3f * length_m, rise - 0.1f, 0}), frame.point({0.3f * length_m, rise + 0.5f, 0}),
                  frame.point({0.3f * length_m, rise + 0.5f, radius_m + 0.3f}), frame.point({0.3f * length_m, 0.2f, radius_m + 0.3f})},
                 0.07f, true);
}

void add_pump(ModelBuilder& builder, const PlantPaints& paints, const Frame& frame, RandomStream& random) {
  const Paint motor = paints.coloured(random.chance(0.5) ? glm::u8vec4(52, 104, 138, 255) : glm::u8vec4(64, 122, 84, 255));
  add_box(builder, paints.concrete, frame, {-0.9f, 0, -0.4f}, {0.9f, 0.25f, 0.4f}, kAllFaces & ~kFaceBottom);
  add_chamfered_box(builder, paints.coloured(kDarkSteel), frame, {-0.85f, 0.25f, -0.32f}, {0.85f, 0.36f, 0.32f}, 0.03f);
  const glm::mat3 along_x = frame.axes * glm::mat3(glm::vec3(0, -1, 0), glm::vec3(1, 0, 0), glm::vec3(0, 0, 1));
  const Frame shaft{frame.point({0, 0.66f, 0}), along_x};
  std::vector<glm::vec2> housing{{0, -0.82f}, {0.2f, -0.8f}, {0.25f, -0.72f}};
  for (int k = 0; k < 4; ++k) {  // cooling fins
    const float y = -0.66f + 0.13f * static_cast<float>(k);
    housing.insert(housing.end(), {{0.25f, y}, {0.29f, y + 0.01f}, {0.29f, y + 0.03f}, {0.25f, y + 0.04f}});
  }
  housing.insert(housing.end(), {{0.25f, -0.1f}, {0.1f, -0.06f}, {0.06f, -0.06f}, {0.06f, 0.2f}, {0.14f, 0.2f}, {0.18f, 0.34f}});
  add_lathe(builder, motor, shaft, housing, 20);
  const std::array<glm::vec2, 6> volute{{{0, 0.3f}, {0.3f, 0.34f}, {0.38f, 0.44f}, {0.38f, 0.52f}, {0.3f, 0.62f}, {0.12f, 0.64f}}};
  add_lathe(builder, motor, shaft, volute, 24);
  const Paint pipe = paints.coloured(pipe_colour(random));
  add_pipe_route(builder, pipe, {frame.point({0.6f, 0.66f, 0}), frame.point({1.5f, 0.66f, 0}), frame.point({1.5f, 3.0f, 0})}, 0.11f, true);
  add_pipe_route(builder, pipe, {frame.point({0.48f, 0.66f, 0.25f}), frame.point({0.48f, 3.1f, 0.25f})}, 0.09f, true);
  add_valve(builder, paints, frame.point({0.48f, 1.6f, 0.25f}), frame.axes * glm::vec3(0, 1, 0), 0.09f);
}

void add_exchanger(ModelBuilder& builder, const PlantPaints& paints, const Frame& frame, float length_m,
                   RandomStream& random) {
  const Paint shell = paints.coloured(random.chance(0.5) ? glm::u8vec4(196, 198, 196, 255) : glm::u8vec4(150, 128, 96, 255));
  const glm::mat3 along_x = frame.axes * glm::mat3(glm::vec3(0, -1, 0), glm::vec3(1, 0, 0), glm::vec3(0, 0, 1));
  const float h = 0.5f * length_m, r = 0.42f;
  for (const float y : {0.95f, 2.15f}) {
    const std::array<glm::vec2, 14> profile{{{0, -h}, {0.3f, -h + 0.02f}, {r, -h + 0.12f}, {r, -h + 0.35f}, {r + 0.1f, -h + 0.35f},
                                             {r + 0.1f, -h + 0.47f}, {r, -h + 0.47f}, {r, h - 0.6f}, {r + 0.1f, h - 0.6f},
                                             {r + 0.1f, h - 0.48f}, {r, h - 0.48f}, {r, h - 0.1f}, {0.3f, h - 0.02f}, {0, h}}};
    add_lathe(builder, shell, Frame{frame.point({0, y, 0}), along_x}, profile, 24);
    for (const float x : {-0.25f * length_m, 0.25f * length_m}) {
      add_box(builder, paints.coloured(kDarkSteel), frame, {x - 0.06f, y - 0.95f, -0.35f}, {x + 0.06f, y - 0.3f, 0.35f}, kNoEnds);
    }
  }
  const float x = -h + 0.7f;
  add_pipe_route(builder, paints.coloured(pipe_colour(random)), {frame.point({x, 1.3f, 0}), frame.point({x, 1.8f, 0})}, 0.12f, true);
  add_pipe_route(builder, paints.coloured(pipe_colour(random)), {frame.point({x, 2.5f, 0}), frame.point({x, 3.6f, 0}), frame.point({x + 1.5f, 3.6f, 0})}, 0.12f, true);
}

void add_cabinet(ModelBuilder& builder, const PlantPaints& paints, const Frame& frame, RandomStream& random) {
  const Paint body = paints.coloured({198, 200, 194, 255}), dark = paints.coloured({60, 64, 68, 255});
  add_box(builder, dark, frame, {-0.4f, 0, -0.3f}, {0.4f, 0.1f, 0.3f}, kAllFaces & ~kFaceBottom);
  add_chamfered_box(builder, body, frame, {-0.4f, 0.1f, -0.3f}, {0.4f, 2.1f, 0.3f}, 0.015f);
  add_chamfered_box(builder, body, frame, {-0.37f, 0.15f, 0.3f}, {0.37f, 2.05f, 0.325f}, 0.008f);
  add_box(builder, dark, frame, {0.28f, 1.0f, 0.325f}, {0.31f, 1.2f, 0.36f}, kAllFaces & ~kFaceBack);
  for (int k = 0; k < 5; ++k) {
    const float y = 0.3f + 0.05f * static_cast<float>(k);
    add_box(builder, dark, frame, {-0.2f, y, 0.326f}, {0.2f, y + 0.02f, 0.332f}, kAllFaces & ~kFaceBack);
  }
  for (int k = 0; k < 3; ++k) {
    const glm::u8vec4 lamp = random.chance(0.5) ? glm::u8vec4(60, 190, 80, 255) : glm::u8vec4(210, 70, 50, 255);
    const std::array<glm::vec2, 4> lens{{{0.02f, 0}, {0.02f, 0.015f}, {0.012f, 0.025f}, {0, 0.027f}}};
    add_lathe(builder, paints.coloured(lamp), Frame::along(frame.point({-0.2f + 0.1f * static_cast<float>(k), 1.7f, 0.325f}), frame.axes[2]), lens, 10);
  }
}

void add_duct(ModelBuilder& builder, const PlantPaints& paints, const Frame& frame, float length_m, glm::vec2 section_m) {
  const Paint sheet = paints.coloured({176, 182, 186, 255}), rib = paints.coloured({140, 146, 152, 255});
  const float half = 0.5f * section_m.x, height = section_m.y;
  add_box(builder, sheet, frame, {0, 0, -half}, {length_m, height, half}, kFaceTop | kFaceBottom | kFaceFront | kFaceBack);
  for (float x = 0.6f; x < length_m; x += 2.0f) {
    for (const float side : {-half - 0.05f, half}) add_box(builder, rib, frame, {x, -0.05f, side}, {x + 0.06f, height + 0.05f, side + 0.05f});
    for (const float y : {-0.05f, height}) add_box(builder, rib, frame, {x, y, -half}, {x + 0.06f, y + 0.05f, half}, kAllFaces & ~(kFaceFront | kFaceBack));
  }
}

}  // namespace farfield
