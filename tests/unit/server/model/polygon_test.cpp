// SPDX-License-Identifier: Apache-2.0
#include "server/model/polygon.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace farfield {
namespace {

using Ring = std::vector<std::uint32_t>;

glm::dvec3 area_vector(const std::vector<glm::dvec3>& p, std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  return 0.5 * glm::cross(p[b] - p[a], p[c] - p[a]);
}

glm::dvec3 ring_area(const std::vector<glm::dvec3>& p, const Ring& ring) {
  glm::dvec3 sum(0);
  for (std::size_t i = 1; i + 1 < ring.size(); ++i) sum += area_vector(p, ring[0], ring[i], ring[i + 1]);
  return sum;
}

/// Every triangle must have the polygon's orientation, and their areas must add up to `area`: then they tile it.
void expect_tiling(const std::vector<glm::dvec3>& points, const Ring& triangles, double area,
                   const glm::dvec3& normal) {
  ASSERT_EQ(triangles.size() % 3, 0u);
  double sum = 0;
  for (std::size_t i = 0; i < triangles.size(); i += 3) {
    const glm::dvec3 a = area_vector(points, triangles[i], triangles[i + 1], triangles[i + 2]);
    EXPECT_GE(glm::dot(a, normal), -1e-12 * area) << "triangle " << i / 3 << " is turned over";
    sum += glm::length(a);
  }
  EXPECT_NEAR(sum, area, 1e-9 * area);
}

TEST(Polygon, TriangulatesAnL) {
  const std::vector<glm::dvec3> points{{0, 0, 0}, {3, 0, 0}, {3, 1, 0}, {1, 1, 0}, {1, 3, 0}, {0, 3, 0}};
  Ring triangles;
  triangulate_polygon(points, triangles);
  EXPECT_EQ(triangles.size(), 12u);
  expect_tiling(points, triangles, 5, {0, 0, 1});
}

TEST(Polygon, KeepsTheWindingInAnyPlane) {
  for (const glm::dvec3 axis : {glm::dvec3(1, 0, 0), glm::dvec3(0, 1, 0), glm::dvec3(0, 0, 1), glm::dvec3(-1, 2, -3)}) {
    const glm::dvec3 n = glm::normalize(axis);
    const glm::dvec3 u = glm::normalize(glm::cross(n, glm::dvec3(0.3, -0.5, 0.8))), v = glm::cross(n, u);
    std::vector<glm::dvec3> points;
    for (const glm::dvec2 p : {glm::dvec2(0, 0), {4, 0}, {4, 4}, {2, 1}, {0, 4}}) {
      points.push_back(glm::dvec3(84616.468, 447423, -15) + p.x * u + p.y * v);
    }
    Ring triangles;
    triangulate_polygon(points, triangles);
    expect_tiling(points, triangles, 10, n);
  }
}

TEST(Polygon, TilesRandomStarPolygons) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> radius(0.1, 1.0);
  for (int round = 0; round < 200; ++round) {
    const std::size_t corners = 4 + static_cast<std::size_t>(round) % 40;
    std::vector<glm::dvec3> points;
    Ring ring;
    for (std::uint32_t i = 0; i < corners; ++i) {
      const double angle = 2 * M_PI * i / static_cast<double>(corners), r = radius(random);
      points.emplace_back(r * std::cos(angle), r * std::sin(angle), 5);
      ring.push_back(i);
    }
    Ring triangles;
    triangulate_polygon(points, triangles);
    EXPECT_EQ(triangles.size(), 3 * (corners - 2));
    expect_tiling(points, triangles, glm::length(ring_area(points, ring)), {0, 0, 1});
  }
}

TEST(Polygon, LeavesHolesOpenWhateverTheirWinding) {
  std::vector<glm::dvec3> points{{0, 0, 0}, {10, 0, 0}, {10, 10, 0}, {0, 10, 0}};
  std::vector<Ring> rings{{0, 1, 2, 3}};
  for (const glm::dvec2 corner : {glm::dvec2(1, 1), {6, 1}, {1, 6}, {6, 6.5}}) {
    const auto base = static_cast<std::uint32_t>(points.size());
    for (const glm::dvec2 d : {glm::dvec2(0, 0), {2, 0}, {2, 2}, {0, 2}}) points.emplace_back(corner + d, 0);
    rings.push_back(rings.size() % 2 ? Ring{base, base + 1, base + 2, base + 3}
                                     : Ring{base + 3, base + 2, base + 1, base});
  }
  Ring triangles;
  triangulate_polygon_with_holes(points, rings, triangles);
  expect_tiling(points, triangles, 100 - 4 * 4, {0, 0, 1});
}

// Windows in a façade: every bridge runs along edges of other holes, the worst case for choosing among twin corners.
TEST(Polygon, TilesAroundGridsOfHoles) {
  std::mt19937 random(19);
  for (int round = 0; round < 100; ++round) {
    const int columns = 1 + round % 6, rows = 1 + round / 20;
    const double tilt = round % 3 == 0 ? 0.0 : 0.37 * round;
    std::vector<glm::dvec3> points;
    std::vector<Ring> rings;
    double area = 0;
    const auto add_box = [&](double x, double y, double w, double h) {
      const auto base = static_cast<std::uint32_t>(points.size());
      for (const glm::dvec2 p : {glm::dvec2(x, y), {x + w, y}, {x + w, y + h}, {x, y + h}}) {
        points.emplace_back(p.x * std::cos(tilt) - p.y * std::sin(tilt), p.x * std::sin(tilt) + p.y * std::cos(tilt),
                            1);
      }
      rings.push_back({base, base + 1, base + 2, base + 3});
      area += rings.size() == 1 ? w * h : -w * h;
    };
    add_box(0, 0, 3 * columns + 1, 3 * rows + 1);
    for (int c = 0; c < columns; ++c) {
      for (int r = 0; r < rows; ++r) {
        if (random() % 4 != 0) add_box(3 * c + 1, 3 * r + 1, 2, 1 + static_cast<double>(random() % 2));
      }
    }
    Ring triangles;
    triangulate_polygon_with_holes(points, rings, triangles);
    expect_tiling(points, triangles, area, {0, 0, 1});
    if (HasFailure()) FAIL() << "in round " << round;
  }
}

TEST(Polygon, NeverFailsOnPolygonsThatAreNotSimple) {
  const std::vector<glm::dvec3> bow_tie{{0, 0, 0}, {2, 2, 0}, {2, 0, 0}, {0, 3, 0}, {1, 5, 0}};
  Ring triangles;
  triangulate_polygon(bow_tie, triangles);
  EXPECT_EQ(triangles.size(), 9u);

  const std::vector<glm::dvec3> line{{0, 0, 0}, {1, 1, 1}, {2, 2, 2}, {3, 3, 3}};
  triangles.clear();
  triangulate_polygon(line, triangles);
  EXPECT_TRUE(triangles.empty());

  const double nan = std::nan("");
  const std::vector<glm::dvec3> broken{{0, 0, 0}, {1, nan, 0}, {1, 1, 0}, {0, 1, 0}};
  triangulate_polygon(broken, triangles);
  EXPECT_TRUE(triangles.empty());
}

TEST(Polygon, IgnoresAHoleOutsideTheOuterRing) {
  const std::vector<glm::dvec3> points{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {5, 5, 0}, {6, 5, 0}, {6, 6, 0}};
  const std::vector<Ring> rings{{0, 1, 2, 3}, {4, 5, 6}};
  Ring triangles;
  triangulate_polygon_with_holes(points, rings, triangles);
  expect_tiling(points, triangles, 1, {0, 0, 1});
}

}  // namespace
}  // namespace farfield
