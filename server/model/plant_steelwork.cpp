// SPDX-License-Identifier: Apache-2.0
// The steel structure of plant_equipment.h: beams, columns, rails and ladders.
#include <algorithm>
#include <cmath>

#include "server/model/plant_equipment.h"

namespace farfield {

void add_beam(ModelBuilder& builder, const Paint& paint, const Frame& frame, float length_m, float height_m) {
  const float flange = 0.25f * height_m, thickness = 0.06f * height_m;
  constexpr unsigned kSides = kAllFaces & ~(kFaceLeft | kFaceRight);
  add_box(builder, paint, frame, {0, -thickness, -flange}, {length_m, 0, flange}, kSides);
  add_box(builder, paint, frame, {0, -height_m, -flange}, {length_m, thickness - height_m, flange}, kSides);
  add_box(builder, paint, frame, {0, thickness - height_m, -0.4f * thickness}, {length_m, -thickness, 0.4f * thickness},
          kFaceFront | kFaceBack);
}

void add_column(ModelBuilder& builder, const Paint& paint, const Frame& frame, float height_m, float width_m) {
  const float half = 0.5f * width_m, thickness = 0.07f * width_m;
  add_box(builder, paint, frame, {-half, 0, -half}, {half, height_m, thickness - half}, kNoEnds);
  add_box(builder, paint, frame, {-half, 0, half - thickness}, {half, height_m, half}, kNoEnds);
  add_box(builder, paint, frame, {-0.5f * thickness, 0, thickness - half}, {0.5f * thickness, height_m, half - thickness},
          kFaceLeft | kFaceRight);
  add_box(builder, paint, frame, {-half - 0.06f, 0, -half - 0.06f}, {half + 0.06f, 0.03f, half + 0.06f}, kAllFaces & ~kFaceBottom);
}

void add_railing(ModelBuilder& builder, const Paint& paint, const Frame& frame, float length_m) {
  const int spans = std::max(1, static_cast<int>(std::lround(length_m / 2.0f)));
  for (int k = 0; k <= spans; ++k) {
    const float x = length_m * static_cast<float>(k) / static_cast<float>(spans);
    add_tube(builder, paint, frame.point({x, 0, 0}), frame.point({x, 1.1f, 0}), 0.022f, 6);
  }
  for (const float y : {0.55f, 1.1f}) add_tube(builder, paint, frame.point({0, y, 0}), frame.point({length_m, y, 0}), 0.022f, 8);
  add_box(builder, paint, frame, {0, 0.01f, -0.006f}, {length_m, 0.15f, 0.006f}, kFaceFront | kFaceBack | kFaceTop);
}

void add_ladder(ModelBuilder& builder, const Paint& paint, const Frame& frame, float height_m) {
  for (const float x : {-0.22f, 0.22f}) add_box(builder, paint, frame, {x - 0.006f, 0, -0.03f}, {x + 0.006f, height_m + 1.0f, 0.03f}, kNoEnds);
  for (float y = 0.3f; y < height_m; y += 0.3f) add_tube(builder, paint, frame.point({-0.22f, y, 0}), frame.point({0.22f, y, 0}), 0.012f, 5);
  for (float y = 2.4f; y < height_m + 0.9f; y += 1.2f) {  // hoops of the cage
    constexpr int kHoopParts = 6;
    glm::vec3 before = frame.point({-0.22f, y, 0});
    for (int k = 1; k <= kHoopParts; ++k) {
      const float angle = 3.14159265f * static_cast<float>(k) / kHoopParts;
      const glm::vec3 here = frame.point({k == kHoopParts ? 0.22f : -0.36f * std::cos(angle), y, 0.72f * std::sin(angle)});
      add_tube(builder, paint, before, here, 0.014f, 4);
      before = here;
    }
  }
}

}  // namespace farfield
