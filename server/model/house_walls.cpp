// SPDX-License-Identifier: Apache-2.0
// The walls, doors and windows of house_furniture.h.
#include <initializer_list>

#include "server/model/house_furniture.h"

namespace farfield {
namespace {

constexpr float kFrameWidth = 0.07f, kFrameDepth = 0.02f;
constexpr glm::u8vec4 kWhite{238, 236, 230, 255};

// One upright rectangle of a wall's face at depth z, its texture aligned along the whole wall.
void add_panel(ModelBuilder& builder, const Paint& paint, const Frame& frame, float left, float right, float bottom, float top, float z, bool faces_front) {
  if (!(right > left && top > bottom)) return;
  const float r = paint.repeats_per_m;
  if (faces_front) {
    add_quad(builder, paint, frame, {left, bottom, z}, {right, bottom, z}, {right, top, z}, {left, top, z}, {left * r, -bottom * r}, {right * r, -top * r});
  } else {
    add_quad(builder, paint, frame, {right, bottom, z}, {left, bottom, z}, {left, top, z}, {right, top, z}, {-right * r, -bottom * r}, {-left * r, -top * r});
  }
}

void add_reveal(ModelBuilder& b, const Paint& paint, const Frame& f, const Opening& o, float t) {
  add_quad(b, paint, f, {o.left_m, o.bottom_m, t}, {o.left_m, o.bottom_m, 0}, {o.left_m, o.top_m, 0}, {o.left_m, o.top_m, t});
  add_quad(b, paint, f, {o.right_m, o.bottom_m, 0}, {o.right_m, o.bottom_m, t}, {o.right_m, o.top_m, t}, {o.right_m, o.top_m, 0});
  add_quad(b, paint, f, {o.left_m, o.top_m, 0}, {o.right_m, o.top_m, 0}, {o.right_m, o.top_m, t}, {o.left_m, o.top_m, t});
  if (o.bottom_m > 0) add_quad(b, paint, f, {o.left_m, o.bottom_m, t}, {o.right_m, o.bottom_m, t}, {o.right_m, o.bottom_m, 0}, {o.left_m, o.bottom_m, 0});
}

}  // namespace

void add_wall(ModelBuilder& builder, const Paint& front, const Paint& back, const Paint& reveal, const Frame& frame,
              float length_m, float height_m, float thickness_m, std::span<const Opening> openings) {
  const auto both = [&](float left, float right, float bottom, float top) {
    add_panel(builder, front, frame, left, right, bottom, top, thickness_m, true);
    add_panel(builder, back, frame, left, right, bottom, top, 0, false);
  };
  float at = 0;
  for (const Opening& opening : openings) {
    both(at, opening.left_m, 0, height_m);
    both(opening.left_m, opening.right_m, 0, opening.bottom_m);
    both(opening.left_m, opening.right_m, opening.top_m, height_m);
    add_reveal(builder, reveal, frame, opening, thickness_m);
    at = opening.right_m;
  }
  both(at, length_m, 0, height_m);
}

void add_door(ModelBuilder& b, const HousePaints& paints, const Frame& f, const Opening& o, float thickness) {
  const Paint white = paints.coloured(kWhite);
  for (const float z : {-kFrameDepth, thickness}) {
    add_chamfered_box(b, white, f, {o.left_m - kFrameWidth, 0, z}, {o.left_m, o.top_m, z + kFrameDepth}, 0.006f);
    add_chamfered_box(b, white, f, {o.right_m, 0, z}, {o.right_m + kFrameWidth, o.top_m, z + kFrameDepth}, 0.006f);
    add_chamfered_box(b, white, f, {o.left_m - kFrameWidth, o.top_m, z}, {o.right_m + kFrameWidth, o.top_m + kFrameWidth, z + kFrameDepth}, 0.006f);
  }
  const float width = o.right_m - o.left_m - 0.02f, z = thickness + kFrameDepth + 0.02f, right = o.left_m - 0.02f;
  add_chamfered_box(b, paints.dark_wood, f, {right - width, 0.01f, z}, {right, o.top_m - 0.02f, z + 0.04f}, 0.004f);
  for (const float y : {0.2f, 1.15f}) {
    add_chamfered_box(b, paints.dark_wood, f, {right - width + 0.12f, y, z + 0.04f}, {right - 0.12f, y + 0.75f, z + 0.048f}, 0.008f);
  }
  const Paint metal = paints.coloured({190, 184, 168, 255});
  add_tube(b, metal, f.point({right - width + 0.07f, 1.02f, z + 0.04f}), f.point({right - width + 0.07f, 1.02f, z + 0.09f}), 0.01f, 10);
  add_chamfered_box(b, metal, f, {right - width + 0.06f, 1.01f, z + 0.085f}, {right - width + 0.19f, 1.03f, z + 0.105f}, 0.006f);
}

void add_window(ModelBuilder& b, const HousePaints& paints, const Frame& f, const Opening& o, float thickness) {
  const Paint white = paints.coloured(kWhite);
  const float z = 0.35f * thickness, h = z + 0.06f, w = 0.06f, middle = 0.5f * (o.left_m + o.right_m);
  for (const float x : {o.left_m, middle - 0.5f * w, o.right_m - w}) add_chamfered_box(b, white, f, {x, o.bottom_m, z}, {x + w, o.top_m, h}, 0.01f);
  for (const float y : {o.bottom_m, o.bottom_m + 0.68f * (o.top_m - o.bottom_m), o.top_m - w}) {
    add_chamfered_box(b, white, f, {o.left_m + w, y, z}, {middle - 0.5f * w, y + w, h}, 0.01f);
    add_chamfered_box(b, white, f, {middle + 0.5f * w, y, z}, {o.right_m - w, y + w, h}, 0.01f);
  }
  add_chamfered_box(b, white, f, {o.left_m - 0.06f, o.bottom_m - 0.03f, h}, {o.right_m + 0.06f, o.bottom_m + 0.01f, thickness + 0.12f}, 0.01f);
}

}  // namespace farfield
