// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/baselines/lod_forest.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>

namespace farfield::bench {
namespace {

using client::SurfaceVertex;

struct Surface {
  std::vector<SurfaceVertex> vertices;
  std::vector<std::uint32_t> indices, chunk_ends;
};

constexpr int kEdge = 64;  // quads

// Gentle hills over [0, 64]², in chunks of 8×8 quads that share no vertex objects, as a scene's chunks do not.
Surface hills() {
  Surface surface;
  for (int chunk = 0; chunk < 64; ++chunk) {
    // Chunks in Morton order, as a k-d tree has them: neighbours in the list are neighbours in space.
    const int cx = (chunk & 1) | (chunk >> 1 & 2) | (chunk >> 2 & 4), cy = (chunk >> 1 & 1) | (chunk >> 2 & 2) | (chunk >> 3 & 4);
    const auto first = static_cast<std::uint32_t>(surface.vertices.size());
    for (int y = 0; y <= 8; ++y)
      for (int x = 0; x <= 8; ++x) {
        const float px = static_cast<float>(8 * cx + x), py = static_cast<float>(8 * cy + y);
        surface.vertices.push_back({{px, 0.5f * std::sin(0.2f * px) * std::cos(0.15f * py), py}, {1, 2, 3, 0}, {0, 0}});
      }
    for (std::uint32_t y = 0; y < 8; ++y)
      for (std::uint32_t x = 0; x < 8; ++x) {
        const std::uint32_t a = first + 9 * y + x;
        for (const std::uint32_t index : {a, a + 1, a + 9, a + 1, a + 10, a + 9}) surface.indices.push_back(index);
      }
    surface.chunk_ends.push_back(static_cast<std::uint32_t>(surface.indices.size()));
  }
  return surface;
}

LodForest forest_of(
    const Surface& surface, const IsFixed& is_fixed = [](const glm::vec3&) { return false; }) {
  return build_lod_forest(surface.vertices, surface.indices, surface.chunk_ends, is_fixed);
}

std::vector<const LodNode*> selected(const LodForest& forest, const glm::vec3& eye, float error_per_metre) {
  std::vector<const LodNode*> nodes;
  select_lods(
      forest, eye, error_per_metre, [](const LodNode&) { return true; }, [&](const LodNode& node) { nodes.push_back(&node); });
  return nodes;
}

TEST(LodForest, ErrorsGrowTowardsTheRootsAndTrianglesBecomeFewer) {
  const LodForest forest = forest_of(hills());
  EXPECT_LT(forest.roots.size(), 5u);
  std::size_t inner = 0;
  for (const LodNode& node : forest.nodes) {
    EXPECT_TRUE(node.child_count > 0 || node.error_m <= 0);
    std::size_t children_indices = 0;
    for (std::uint32_t c = node.first_child; c < node.first_child + node.child_count; ++c) {
      EXPECT_GE(node.error_m, forest.nodes[c].error_m);
      EXPECT_TRUE(glm::all(glm::lessThanEqual(node.min, forest.nodes[c].min)) &&
                  glm::all(glm::greaterThanEqual(node.max, forest.nodes[c].max)));
      children_indices += forest.nodes[c].index_count;
    }
    if (node.child_count == 0) continue;
    EXPECT_LT(node.index_count, children_indices);
    ++inner;
  }
  EXPECT_GT(inner, 15u);
}

// Every vertex of a coarse node is one of the mesh's own, and lies on it; what matters is how far the surface between has moved.
TEST(LodForest, CoarseSurfacesStayWithinTheirError) {
  const LodForest forest = forest_of(hills());
  for (const std::uint32_t root : forest.roots) {
    const LodNode& node = forest.nodes[root];
    float worst = 0;
    for (std::uint32_t i = node.first_index; i < node.first_index + node.index_count; i += 3) {
      glm::vec3 centre(0);
      for (std::uint32_t k = 0; k < 3; ++k) centre += forest.vertices[forest.indices[i + k]].position / 3.0f;
      worst = std::max(worst, std::abs(centre.y - 0.5f * std::sin(0.2f * centre.x) * std::cos(0.15f * centre.z)));
    }
    // Quadric error is an average over the planes that met in a vertex: a surface may lie a few times as far away.
    EXPECT_LT(worst, 4 * node.error_m + 0.01f);
  }
}

// Edges that only one drawn triangle has: in any cut there are none but the border of the whole surface.
TEST(LodForest, AnyCutIsWithoutCracks) {
  const LodForest forest = forest_of(hills());
  std::set<std::size_t> sizes;
  for (const float error_per_metre : {0.0f, 0.0005f, 0.002f, 0.01f, 1.0f})
    for (const glm::vec3& eye : {glm::vec3(-5, 2, -5), glm::vec3(70, 10, 30)}) {
      std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
      std::size_t triangles = 0;
      for (const LodNode* node : selected(forest, eye, error_per_metre))
        for (std::uint32_t i = node->first_index; i < node->first_index + node->index_count; i += 3, ++triangles)
          for (std::uint32_t k = 0; k < 3; ++k) {
            const std::uint32_t a = forest.indices[i + k], b = forest.indices[i + (k + 1) % 3];
            ++edges[std::minmax(a, b)];
          }
      sizes.insert(triangles);
      for (const auto& [edge, count] : edges) {
        const glm::vec3 a = forest.vertices[edge.first].position, b = forest.vertices[edge.second].position;
        const bool is_rim = (a.x == b.x && (a.x == 0 || a.x == kEdge)) || (a.z == b.z && (a.z == 0 || a.z == kEdge));
        EXPECT_TRUE(count == 2 || (count == 1 && is_rim)) << count;
      }
    }
  EXPECT_GT(sizes.size(), 4u);  // the cuts were different ones
}

// The side where another mesh goes on stays as it is at every level; the free side does not.
TEST(LodForest, FixedPositionsStay) {
  const LodForest forest = forest_of(hills(), [](const glm::vec3& p) { return p.x == 0; });
  for (const float error_per_metre : {0.0f, 0.01f, 10.0f}) {
    std::set<float> fixed, free;
    for (const LodNode* node : selected(forest, {-5, 2, -5}, error_per_metre))
      for (std::uint32_t i = node->first_index; i < node->first_index + node->index_count; ++i) {
        const glm::vec3& p = forest.vertices[forest.indices[i]].position;
        if (p.x == 0) fixed.insert(p.z);
        if (p.x == kEdge) free.insert(p.z);
      }
    EXPECT_EQ(fixed.size(), kEdge + 1u);
    EXPECT_TRUE(error_per_metre < 1 || free.size() < kEdge / 2u);
  }
}

TEST(LodForest, NoErrorAllowedIsTheMeshItself) {
  const Surface surface = hills();
  const LodForest forest = forest_of(surface);
  std::size_t indices = 0;
  for (const LodNode* node : selected(forest, {0, 1, 0}, 0)) indices += node->index_count;
  EXPECT_EQ(indices, surface.indices.size());
}

TEST(LodForest, WhatMustStayStaysAndNothingIsNothing) {
  const LodForest forest = forest_of(hills(), [](const glm::vec3&) { return true; });
  EXPECT_EQ(forest.roots.size(), 64u);
  EXPECT_EQ(forest.nodes.size(), 64u);
  EXPECT_TRUE(forest_of({}).nodes.empty());
}

}  // namespace
}  // namespace farfield::bench
