// SPDX-License-Identifier: Apache-2.0
#include "server/impostor/voronoi.h"

#include <gtest/gtest.h>

#include <random>

namespace farfield {
namespace {

double nearest_distance(const std::vector<glm::dvec3>& sites, const glm::dvec3& point) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const glm::dvec3& site : sites) nearest = std::min(nearest, glm::distance(site, point));
  return nearest;
}

bool has_vertex_at(const std::vector<glm::dvec3>& vertices, const glm::dvec3& point, double slack) {
  for (const glm::dvec3& vertex : vertices)
    if (glm::distance(vertex, point) < slack) return true;
  return false;
}

std::vector<glm::dvec3> random_sites(std::mt19937& random, const Box& box, int count) {
  std::uniform_real_distribution<double> unit(0, 1);
  std::vector<glm::dvec3> sites;
  for (int k = 0; k < count; ++k) sites.push_back(box.min + box.extent() * glm::dvec3(unit(random), unit(random), unit(random)));
  return sites;
}

const Box kBoxes[] = {{{0, 0, 0}, {1, 1, 1}}, {{-3, 5, 100}, {-1, 9, 101}}, {{1e6, 1e6, -1e6}, {1e6 + 512, 1e6 + 512, -1e6 + 512}}};

TEST(Voronoi, VerticesAreEquidistantInsideTheBoxAndNearestToTheirSites) {
  std::mt19937 random(1);
  for (const Box& box : kBoxes)
    for (int count = 2; count <= 7; ++count) {
      const std::vector<glm::dvec3> sites = random_sites(random, box, count);
      const std::vector<glm::dvec3> vertices = voronoi_vertices(sites, box);
      ASSERT_FALSE(vertices.empty());
      const double slack = 1e-7 * glm::length(box.extent());
      for (const glm::dvec3& vertex : vertices) {
        const double radius = nearest_distance(sites, vertex);
        int owners = 0, faces = 0;
        for (const glm::dvec3& site : sites) owners += glm::distance(site, vertex) < radius + slack;
        for (int axis = 0; axis < 3; ++axis) {
          EXPECT_GE(vertex[axis], box.min[axis] - slack);
          EXPECT_LE(vertex[axis], box.max[axis] + slack);
          faces += std::abs(vertex[axis] - box.min[axis]) < slack;
          faces += std::abs(vertex[axis] - box.max[axis]) < slack;
        }
        EXPECT_GE(owners, 2);
        EXPECT_GE(owners + faces, 4) << "three equations fix a point";
      }
    }
}

// Distance to the nearest site is convex within each Voronoi cell, so its maximum over the box lies at a vertex of the
// diagram or at a corner of the box: no point of a dense grid may be farther from all sites than the best of these.
TEST(Voronoi, NoPointOfTheBoxIsFartherFromAllSitesThanTheBestVertex) {
  std::mt19937 random(2);
  for (const Box& box : kBoxes)
    for (int trial = 0; trial < 4; ++trial) {
      // Sites at the corners as well: there the maximum always lies at a vertex.
      std::vector<glm::dvec3> sites = random_sites(random, box, trial);
      for (int corner = 0; corner < 8; ++corner)
        sites.push_back(box.min + box.extent() * glm::dvec3(corner & 1, corner >> 1 & 1, corner >> 2));
      double best = 0;
      for (const glm::dvec3& vertex : voronoi_vertices(sites, box)) best = std::max(best, nearest_distance(sites, vertex));
      constexpr int kSteps = 24;
      double farthest = 0;
      for (int z = 0; z <= kSteps; ++z)
        for (int y = 0; y <= kSteps; ++y)
          for (int x = 0; x <= kSteps; ++x)
            farthest = std::max(farthest, nearest_distance(sites, box.min + box.extent() * (glm::dvec3(x, y, z) / double{kSteps})));
      const double scale = glm::length(box.extent());
      EXPECT_LE(farthest, best + 1e-7 * scale);
      EXPECT_GE(farthest, best - scale / kSteps) << "and the best vertex is not beyond what the grid can come close to";
    }
}

TEST(Voronoi, EightCornersMeetInTheCentreTheFacesAndTheEdges) {
  const Box box{{10, 20, 30}, {14, 24, 34}};
  std::vector<glm::dvec3> sites;
  for (int corner = 0; corner < 8; ++corner)
    sites.push_back(box.min + box.extent() * glm::dvec3(corner & 1, corner >> 1 & 1, corner >> 2));
  const std::vector<glm::dvec3> vertices = voronoi_vertices(sites, box);
  EXPECT_EQ(vertices.size(), 1u + 6u + 12u);
  EXPECT_TRUE(has_vertex_at(vertices, box.center(), 1e-9));
  EXPECT_TRUE(has_vertex_at(vertices, {10, 22, 32}, 1e-9)) << "centre of a face";
  EXPECT_TRUE(has_vertex_at(vertices, {12, 20, 34}, 1e-9)) << "middle of an edge";
}

TEST(Voronoi, TwoSitesGiveTheRectangleBetweenThem) {
  const std::vector<glm::dvec3> vertices = voronoi_vertices({{0.25, 0.5, 0.5}, {0.5, 0.5, 0.5}}, {{0, 0, 0}, {1, 1, 1}});
  EXPECT_EQ(vertices.size(), 4u);
  for (const glm::dvec3& corner : {glm::dvec3(0.375, 0, 0), glm::dvec3(0.375, 1, 0), glm::dvec3(0.375, 0, 1), glm::dvec3(0.375, 1, 1)})
    EXPECT_TRUE(has_vertex_at(vertices, corner, 1e-9));
}

TEST(Voronoi, NothingToDivideGivesNoVertices) {
  const Box box{{0, 0, 0}, {1, 1, 1}};
  EXPECT_TRUE(voronoi_vertices({}, box).empty());
  EXPECT_TRUE(voronoi_vertices({{0.5, 0.5, 0.5}}, box).empty());
  EXPECT_TRUE(voronoi_vertices({{0.5, 0.5, 0.5}, {0.5, 0.5, 0.5}}, box).empty()) << "the same site twice";
  EXPECT_TRUE(voronoi_vertices({{0, 0, 0}, {1, 1, 1}}, {{1, 1, 1}, {1, 1, 1}}).empty()) << "a box without extent";
}

}  // namespace
}  // namespace farfield
