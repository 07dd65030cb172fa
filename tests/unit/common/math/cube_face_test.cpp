// SPDX-License-Identifier: Apache-2.0
#include "common/math/cube_face.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <set>

namespace farfield {
namespace {

TEST(CubeFace, EveryDirectionLiesOnItsDominantFaceWithinTheUnitSquare) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> coordinate(-1, 1);
  std::set<int> seen;
  for (int i = 0; i < 2000; ++i) {
    const glm::dvec3 direction{coordinate(random), coordinate(random), coordinate(random)};
    const int face = dominant_face(direction);
    seen.insert(face);
    const CubeFace cube = CubeFace::of(face);
    const double along = direction[cube.axis] * cube.sign;
    ASSERT_GT(along, 0);
    const double u = direction[cube.u_axis()] / along, v = direction[cube.v_axis()] / along;
    EXPECT_LE(std::abs(u), 1);
    EXPECT_LE(std::abs(v), 1);
    EXPECT_LT(glm::length(glm::normalize(cube.direction(u, v)) - glm::normalize(direction)), 1e-12);
  }
  EXPECT_EQ(seen.size(), 6u);
}

TEST(CubeFace, SampleIndexInvertsSampleTangent) {
  for (const int edge : {128, 1514, 2396}) {
    for (int i = 0; i < edge; i += 7) EXPECT_NEAR(sample_index(edge, sample_tangent(edge, i)), i, 1e-9);
  }
}

TEST(CubeFace, TheGridReachesHalfASampleBeyondTheEdgeOnBothSides) {
  const int edge = 1514;
  const double half = 0.5 * sample_pitch(edge);
  EXPECT_NEAR(sample_tangent(edge, 0), -1 - half, 1e-12);
  EXPECT_NEAR(sample_tangent(edge, edge - 1), 1 + half, 1e-12);
}

// Adjacent faces see the cube's edge from both sides: their directions there are the same lines.
TEST(CubeFace, FacesMeetAtTheirEdges) {
  for (int face = 0; face < kCubeFaces; ++face) {
    const CubeFace cube = CubeFace::of(face);
    for (const double v : {-0.7, 0.0, 0.4}) {
      for (const double u : {-1.0, 1.0}) {
        const glm::dvec3 direction = cube.direction(u, v);
        const CubeFace next = CubeFace::of(2 * cube.u_axis() + (u < 0 ? 1 : 0));
        const double along = direction[next.axis] * next.sign;
        EXPECT_NEAR(along, 1, 1e-15);
        const double u2 = direction[next.u_axis()] / along, v2 = direction[next.v_axis()] / along;
        EXPECT_LT(glm::length(next.direction(u2, v2) - direction), 1e-15);
      }
    }
  }
}

}  // namespace
}  // namespace farfield
