// SPDX-License-Identifier: Apache-2.0
// The shapes of shapes.h that turn about an axis.
#include <algorithm>
#include <cmath>
#include <vector>

#include "server/model/shapes.h"

namespace farfield {
namespace {

constexpr float kTau = 6.28318530718f;
const float kCreaseCosine = std::cos(kTau * 40 / 360);

glm::vec2 direction_of(float part) { return {std::cos(kTau * part), std::sin(kTau * part)}; }

// A strip of quads between two rings of sides + 1 vertices (the last repeats the first with another u).
void join_rings(ModelBuilder& builder, int material, std::uint32_t lower, std::uint32_t upper, int sides) {
  for (int k = 0; k < sides; ++k) {
    const std::uint32_t i = static_cast<std::uint32_t>(k);
    builder.triangle(material, lower + i, upper + i, upper + i + 1);
    builder.triangle(material, lower + i, upper + i + 1, lower + i + 1);
  }
}

// One ring about the frame's y axis. Radial direction at part t: (cos, ·, sin). Returns the first vertex.
std::uint32_t add_ring(ModelBuilder& builder, const Paint& paint, const Frame& frame, float radius, float height,
                       const glm::vec2& normal, float v, int sides) {
  std::uint32_t first = 0;
  for (int k = 0; k <= sides; ++k) {
    const glm::vec2 d = direction_of(static_cast<float>(k % sides) / static_cast<float>(sides));
    const float u = kTau * static_cast<float>(k) / static_cast<float>(sides) * std::max(radius, 0.1f);
    const std::uint32_t i = builder.vertex(
        paint.material, frame.point({radius * d.x, height, radius * d.y}),
        frame.axes * glm::vec3(normal.x * d.x, normal.y, normal.x * d.y), paint.repeats_per_m * glm::vec2(u, -v),
        paint.colour);
    if (k == 0) first = i;
  }
  return first;
}

}  // namespace

void add_lathe(ModelBuilder& builder, const Paint& paint, const Frame& frame, std::span<const glm::vec2> profile,
               int sides) {
  const auto segment_normal = [&](std::size_t i) {  // of the segment from point i to i + 1, outward
    const glm::vec2 d = profile[i + 1] - profile[i];
    return glm::normalize(glm::vec2(d.y, -d.x));
  };
  float v = 0;
  std::uint32_t lower = 0;
  for (std::size_t i = 0; i + 1 < profile.size(); ++i) {
    const glm::vec2 here = segment_normal(i);
    const auto blended = [&](const glm::vec2& other) {
      return glm::dot(here, other) > kCreaseCosine ? glm::normalize(here + other) : here;
    };
    const bool continues = i > 0 && glm::dot(here, segment_normal(i - 1)) > kCreaseCosine;
    if (!continues) lower = add_ring(builder, paint, frame, profile[i].x, profile[i].y, here, v, sides);
    v += glm::length(profile[i + 1] - profile[i]);
    const glm::vec2 end = i + 2 < profile.size() ? blended(segment_normal(i + 1)) : here;
    const std::uint32_t upper = add_ring(builder, paint, frame, profile[i + 1].x, profile[i + 1].y, end, v, sides);
    join_rings(builder, paint.material, lower, upper, sides);
    lower = upper;
  }
}

void add_tube(ModelBuilder& builder, const Paint& paint, const glm::vec3& from, const glm::vec3& to, float radius_m,
              int sides, float end_radius_m) {
  const glm::vec3 axis = to - from;
  const float length = glm::length(axis);
  if (!(length > 1e-4f)) return;  // a tenth of a millimetre: rounding of the route, not a pipe
  const Frame frame = Frame::along(from, axis / length);
  const glm::vec2 normal{1, 0};
  const std::uint32_t lower = add_ring(builder, paint, frame, radius_m, 0, normal, 0, sides);
  const std::uint32_t upper =
      add_ring(builder, paint, frame, end_radius_m < 0 ? radius_m : end_radius_m, length, normal, length, sides);
  join_rings(builder, paint.material, lower, upper, sides);
}

void add_bend(ModelBuilder& builder, const Paint& paint, const glm::vec3& corner, const glm::vec3& incoming,
              const glm::vec3& outgoing, float bend_radius_m, float radius_m, int sides, int segments) {
  const float cosine = glm::clamp(glm::dot(incoming, outgoing), -1.0f, 1.0f);
  const float turn = std::acos(cosine);
  const float setback = bend_radius_m * std::tan(0.5f * turn);
  const glm::vec3 side = glm::normalize(outgoing - cosine * incoming);
  const glm::vec3 center = corner - setback * incoming + bend_radius_m * side;
  std::uint32_t lower = 0;
  for (int k = 0; k <= segments; ++k) {
    const float angle = turn * static_cast<float>(k) / static_cast<float>(segments);
    const glm::vec3 tangent = std::cos(angle) * incoming + std::sin(angle) * side;
    const glm::vec3 inward = std::cos(angle) * side - std::sin(angle) * incoming;
    const Frame frame{center - bend_radius_m * inward, glm::mat3(inward, tangent, glm::cross(inward, tangent))};
    const std::uint32_t upper = add_ring(builder, paint, frame, radius_m, 0, {1, 0}, angle * bend_radius_m, sides);
    if (k > 0) join_rings(builder, paint.material, lower, upper, sides);
    lower = upper;
  }
}

void add_torus(ModelBuilder& builder, const Paint& paint, const Frame& frame, float ring_radius_m, float radius_m,
               int segments, int sides) {
  std::vector<glm::vec2> profile;
  for (int k = 0; k <= sides; ++k) {
    const glm::vec2 d = direction_of(static_cast<float>(k) / static_cast<float>(sides));
    profile.emplace_back(ring_radius_m + radius_m * d.x, radius_m * d.y);
  }
  add_lathe(builder, paint, frame, profile, segments);
}

}  // namespace farfield
