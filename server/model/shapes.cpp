// SPDX-License-Identifier: Apache-2.0
#include "server/model/shapes.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace farfield {

Frame Frame::at(const glm::vec3& origin, float yaw_rad) {
  const float c = std::cos(yaw_rad), s = std::sin(yaw_rad);
  return {origin, glm::mat3(glm::vec3(c, 0, -s), glm::vec3(0, 1, 0), glm::vec3(s, 0, c))};
}

Frame Frame::along(const glm::vec3& origin, const glm::vec3& y_axis) {
  const glm::vec3 other = std::abs(y_axis.y) < 0.9f ? glm::vec3(0, 1, 0) : glm::vec3(1, 0, 0);
  const glm::vec3 x = glm::normalize(glm::cross(y_axis, other));
  return {origin, glm::mat3(x, y_axis, glm::cross(x, y_axis))};
}

Frame Frame::moved(const glm::vec3& local_offset, float yaw_rad) const {
  return {point(local_offset), axes * at({}, yaw_rad).axes};
}

void add_quad(ModelBuilder& builder, const Paint& paint, const Frame& frame, const glm::vec3& a, const glm::vec3& b,
              const glm::vec3& c, const glm::vec3& d) {
  const float r = paint.repeats_per_m;
  // Images hang with v downwards: the first edge is the lower one.
  add_quad(builder, paint, frame, a, b, c, d, {0, 0}, {glm::length(b - a) * r, -glm::length(d - a) * r});
}

void add_quad(ModelBuilder& builder, const Paint& paint, const Frame& frame, const glm::vec3& a, const glm::vec3& b,
              const glm::vec3& c, const glm::vec3& d, const glm::vec2& uv_a, const glm::vec2& uv_c) {
  const glm::vec3 normal = frame.axes * glm::normalize(glm::cross(c - a, d - b));
  const auto corner = [&](const glm::vec3& p, float u, float v) {
    return builder.vertex(paint.material, frame.point(p), normal, {u, v}, paint.colour);
  };
  const std::uint32_t i = corner(a, uv_a.x, uv_a.y);
  corner(b, uv_c.x, uv_a.y);
  corner(c, uv_c.x, uv_c.y);
  corner(d, uv_a.x, uv_c.y);
  builder.triangle(paint.material, i, i + 1, i + 2);
  builder.triangle(paint.material, i, i + 2, i + 3);
}

void add_triangle(ModelBuilder& builder, const Paint& paint, const Frame& frame, const glm::vec3& a,
                  const glm::vec3& b, const glm::vec3& c) {
  const glm::vec3 normal = frame.axes * glm::normalize(glm::cross(b - a, c - a));
  const glm::vec3 u = glm::normalize(b - a);
  const float r = paint.repeats_per_m;
  const glm::vec3 across = c - a - u * glm::dot(c - a, u);
  const std::uint32_t i = builder.vertex(paint.material, frame.point(a), normal, {0, 0}, paint.colour);
  builder.vertex(paint.material, frame.point(b), normal, {glm::length(b - a) * r, 0}, paint.colour);
  builder.vertex(paint.material, frame.point(c), normal, {glm::dot(c - a, u) * r, -glm::length(across) * r},
                 paint.colour);
  builder.triangle(paint.material, i, i + 1, i + 2);
}

void add_box(ModelBuilder& builder, const Paint& paint, const Frame& frame, const glm::vec3& l, const glm::vec3& h,
             unsigned faces) {
  const auto face = [&](unsigned bit, glm::vec3 a, glm::vec3 b, glm::vec3 c, glm::vec3 d) {
    if (faces & bit) add_quad(builder, paint, frame, a, b, c, d);
  };
  face(kFaceRight, {h.x, l.y, h.z}, {h.x, l.y, l.z}, {h.x, h.y, l.z}, {h.x, h.y, h.z});
  face(kFaceLeft, {l.x, l.y, l.z}, {l.x, l.y, h.z}, {l.x, h.y, h.z}, {l.x, h.y, l.z});
  face(kFaceTop, {l.x, h.y, h.z}, {h.x, h.y, h.z}, {h.x, h.y, l.z}, {l.x, h.y, l.z});
  face(kFaceBottom, {l.x, l.y, l.z}, {h.x, l.y, l.z}, {h.x, l.y, h.z}, {l.x, l.y, h.z});
  face(kFaceFront, {l.x, l.y, h.z}, {h.x, l.y, h.z}, {h.x, h.y, h.z}, {l.x, h.y, h.z});
  face(kFaceBack, {h.x, l.y, l.z}, {l.x, l.y, l.z}, {l.x, h.y, l.z}, {h.x, h.y, l.z});
}

void add_chamfered_box(ModelBuilder& builder, const Paint& paint, const Frame& frame, const glm::vec3& low,
                       const glm::vec3& high, float chamfer_m) {
  const glm::vec3 center = 0.5f * (low + high), half = 0.5f * (high - low);
  const float chamfer = std::min(chamfer_m, 0.45f * std::min({half.x, half.y, half.z}));
  // 24 vertices: corner s (bit per axis) seen from the face of each of its three axes. They carry the face normals,
  // so that the cut edges and corners between them are shaded round.
  std::uint32_t first = 0;
  for (int s = 0; s < 8; ++s) {
    for (int axis = 0; axis < 3; ++axis) {
      const glm::vec3 sign{s & 1 ? 1 : -1, s & 2 ? 1 : -1, s & 4 ? 1 : -1};
      glm::vec3 p = sign * (half - chamfer), n{0};
      p[axis] = sign[axis] * half[axis];
      n[axis] = sign[axis];
      const int u = axis == 0 ? 2 : 0, v = axis == 1 ? 2 : 1;
      const std::uint32_t i =
          builder.vertex(paint.material, frame.point(center + p), frame.axes * n,
                         paint.repeats_per_m * glm::vec2(p[u], -p[v]), paint.colour);
      if (s == 0 && axis == 0) first = i;
    }
  }
  const auto id = [first](int s, int axis) { return first + static_cast<std::uint32_t>(3 * s + axis); };
  const auto quad = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d, bool flip) {
    if (flip) std::swap(b, d);
    builder.triangle(paint.material, a, b, c);
    builder.triangle(paint.material, a, c, d);
  };
  for (int axis = 0; axis < 3; ++axis) {
    const int u = 1 << ((axis + 1) % 3), v = 1 << ((axis + 2) % 3), w = 1 << axis;
    for (const int side : {0, w}) {  // the face
      quad(id(side, axis), id(side | u, axis), id(side | u | v, axis), id(side | v, axis), side == 0);
    }
    const int b = (axis + 1) % 3, c = (axis + 2) % 3;  // the four edges along this axis, between faces b and c
    for (const int edge : {0, u, v, u | v}) {
      const bool flip = (edge == u) || (edge == v);
      quad(id(edge, b), id(edge | w, b), id(edge | w, c), id(edge, c), !flip);
    }
  }
  for (int s = 0; s < 8; ++s) {
    const bool odd = ((s & 1) + ((s >> 1) & 1) + ((s >> 2) & 1)) % 2 == 1;
    if (odd) {
      builder.triangle(paint.material, id(s, 0), id(s, 1), id(s, 2));
    } else {
      builder.triangle(paint.material, id(s, 0), id(s, 2), id(s, 1));
    }
  }
}

}  // namespace farfield
