// SPDX-License-Identifier: Apache-2.0
#include "client/near/clip_surface.h"

#include <gtest/gtest.h>

#include <random>

namespace farfield::client {
namespace {

struct Surface {
  std::vector<SurfaceVertex> vertices;
  std::vector<std::uint32_t> indices;

  void add(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
    for (const glm::vec3& p : {a, b, c}) {
      indices.push_back(static_cast<std::uint32_t>(vertices.size()));
      // Attributes linear in the position, so that interpolated ones can be checked at any place.
      vertices.push_back({p, glm::u16vec4(30000.0f + 1000.0f * p.x, 30000.0f + 1000.0f * p.y, 30000.0f, 0), {p.y, p.z}});
    }
  }
  double area() const {
    double sum = 0;
    for (std::size_t i = 0; i + 2 < indices.size(); i += 3) {
      const glm::dvec3 a(vertices[indices[i]].position), b(vertices[indices[i + 1]].position),
          c(vertices[indices[i + 2]].position);
      sum += 0.5 * glm::length(glm::cross(b - a, c - a));
    }
    return sum;
  }
  Surface clipped(const SurfaceBounds& box) const {
    Surface result = *this;
    clip_surface(box, 0, result.vertices, result.indices);
    return result;
  }
};

class ClipSurface : public ::testing::Test {
 protected:
  glm::vec3 random_point(float reach) {
    std::uniform_real_distribution<float> at(-reach, reach);
    return {at(random_), at(random_), at(random_)};
  }
  std::mt19937 random_{7};
  const SurfaceBounds box_{glm::vec3(-1), glm::vec3(1)};
};

TEST_F(ClipSurface, PiecesOfADividedBoxAddUp) {
  Surface surface;
  for (int i = 0; i < 300; ++i) surface.add(random_point(2), random_point(2), random_point(2));
  const double whole = surface.clipped(box_).area();
  EXPECT_GT(whole, 10);
  double sum = 0;
  for (int corner = 0; corner < 8; ++corner) {
    SurfaceBounds part;
    for (int axis = 0; axis < 3; ++axis) {
      const bool is_upper = corner >> axis & 1;
      part.min[axis] = is_upper ? 0.25f : -1.0f, part.max[axis] = is_upper ? 1.0f : 0.25f;
    }
    sum += surface.clipped(part).area();
  }
  EXPECT_NEAR(sum, whole, 1e-5 * whole);
}

TEST_F(ClipSurface, AttributesFollowThePlace) {
  Surface surface;
  for (int i = 0; i < 300; ++i) surface.add(random_point(3), random_point(3), random_point(3));
  const Surface clipped = surface.clipped(box_);
  ASSERT_FALSE(clipped.indices.empty());
  for (const std::uint32_t index : clipped.indices) {
    const SurfaceVertex& v = clipped.vertices[index];
    for (int axis = 0; axis < 3; ++axis) EXPECT_LE(std::abs(v.position[axis]), 1.0f + 1e-5f);
    EXPECT_NEAR(v.radiance.x, 30000 + 1000 * v.position.x, 4);  // rounded once per border, and at its ends
    EXPECT_NEAR(v.uv.x, v.position.y, 2e-5);
  }
}

TEST_F(ClipSurface, TrianglesThatShareAnEdgeMeetOnIt) {
  for (int i = 0; i < 300; ++i) {
    const glm::vec3 a = random_point(2), b = random_point(2);
    Surface one, other;
    one.add(a, b, random_point(2));
    other.add(b, a, random_point(2));  // the other way round
    const auto on_edge = [&](const Surface& surface) {
      std::vector<std::array<float, 3>> found;
      for (std::size_t k = 3; k < surface.vertices.size(); ++k) {
        const glm::vec3 p = surface.vertices[k].position;
        const glm::vec3 off = p - a - (b - a) * (glm::dot(p - a, b - a) / glm::dot(b - a, b - a));
        if (glm::length(off) < 1e-5f) found.push_back({p.x, p.y, p.z});
      }
      std::sort(found.begin(), found.end());
      return found;
    };
    const auto first = on_edge(one.clipped(box_)), second = on_edge(other.clipped(box_));
    if (!first.empty() && !second.empty()) EXPECT_EQ(first, second);
  }
}

TEST_F(ClipSurface, TheBoxIsHalfOpen) {
  for (int axis = 0; axis < 3; ++axis) {
    for (const float side : {-1.0f, 1.0f}) {
      glm::vec3 a(0), b(0), c(0);
      a[axis] = b[axis] = c[axis] = side;
      b[(axis + 1) % 3] = 0.5f, c[(axis + 2) % 3] = 0.5f;
      Surface surface;
      surface.add(a, b, c);
      EXPECT_EQ(surface.clipped(box_).indices.size(), side < 0 ? 3u : 0u);
    }
  }
}

TEST_F(ClipSurface, WhatIsInsideStaysAsItIs) {
  Surface surface;
  for (int i = 0; i < 20; ++i) surface.add(random_point(0.9f), random_point(0.9f), random_point(0.9f));
  const Surface clipped = surface.clipped(box_);
  EXPECT_EQ(clipped.indices, surface.indices);
  EXPECT_EQ(clipped.vertices.size(), surface.vertices.size());
}

}  // namespace
}  // namespace farfield::client
