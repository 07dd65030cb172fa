// SPDX-License-Identifier: Apache-2.0
#include "server/cells/cell_tree.h"

#include <gtest/gtest.h>

#include <limits>
#include <thread>

#include "tests/unit/server/impostor/block_scenes.h"

namespace farfield {
namespace {

using test::PlacedScene;

constexpr std::uint32_t kBudget = 4000;

// Wide ground with one crowded place: 125 boxes of 192 triangles within 10 m around (20, 5, 20).
PlacedScene crowded_place() {
  test::Blocks blocks;
  blocks.quad({-128, 0, 128}, {256, 0, 0}, {0, 0, -256}, {90, 110, 80, 255}, 8);
  for (int z = 0; z < 5; ++z)
    for (int y = 0; y < 5; ++y)
      for (int x = 0; x < 5; ++x) blocks.box(test::cube({16 + 2 * x, 1 + 2 * y, 16 + 2 * z}, 0.75), {170, 100, 80, 255}, 4);
  return blocks.build();
}

class CellTreeTest : public testing::Test {
 protected:
  static const PlacedScene& placed() {
    static const PlacedScene scene = crowded_place();
    return scene;
  }
  static NestedShells shells() { return {CellGrid{0.5}, 2.0}; }
  static std::unique_ptr<CellTree> tree() { return std::make_unique<CellTree>(placed().scene, shells(), kBudget); }
  static std::vector<glm::dvec3> viewpoints() {
    std::vector<glm::dvec3> points;
    for (const glm::dvec3& world : {glm::dvec3(21, 5.9, 21), glm::dvec3(13, 2, 14), glm::dvec3(-90, 2, -80), glm::dvec3(20.9, 3.9, 19), glm::dvec3(40, 1.7, 20)})
      points.push_back(placed().at(world));
    return points;
  }
};

TEST_F(CellTreeTest, LeavesAreSmallWhereTheModelIsDenseAndLargeWhereItIsEmpty) {
  const auto cells = tree();
  const CellId dense = cells->leaf_at(placed().at({21, 5.9, 21}), nullptr).value();
  const CellId empty = cells->leaf_at(placed().at({-90, 2, -80}), nullptr).value();
  EXPECT_LE(dense.level + 2, empty.level);
}

TEST_F(CellTreeTest, EveryLeafHoldsItsViewerAndKeepsTheBudget) {
  const auto cells = tree();
  for (const glm::dvec3& viewpoint : viewpoints()) {
    const CellId leaf = cells->leaf_at(viewpoint, nullptr).value();
    EXPECT_TRUE(shells().grid.box(leaf).contains(viewpoint));
    EXPECT_TRUE(cells->is_leaf(leaf, nullptr).value());
    EXPECT_TRUE(leaf.is_within(cells->root_for(viewpoint)));
    for (CellId above = leaf; above.level < cells->root_for(viewpoint).level;) {
      above = above.parent();
      EXPECT_FALSE(cells->is_leaf(above, nullptr).value()) << "a leaf's ancestors are divided";
    }
    const auto seen = cells->visibility(leaf, nullptr).value();
    if (leaf.level > 0) { EXPECT_LE(seen->near_triangles, kBudget); }
    std::size_t triangles = 0;
    for (const std::uint32_t chunk : seen->near_chunks) triangles += placed().scene->chunks()[chunk].triangles;
    EXPECT_EQ(triangles, seen->near_triangles);
  }
}

TEST_F(CellTreeTest, TheFallbackCellIsTheLargestThatHoldsFewTriangles) {
  const auto cells = tree();
  const auto triangles_in = [&](const CellId& cell) {
    std::size_t sum = 0;
    for (const std::uint32_t chunk : placed().scene->chunks_in(shells().fallback_region(cell))) sum += placed().scene->chunks()[chunk].triangles;
    return sum;
  };
  for (const glm::dvec3& viewpoint : viewpoints()) {
    const CellId cell = cells->fallback_cell(viewpoint);
    EXPECT_TRUE(shells().grid.box(cell).contains(viewpoint));
    if (cell.level > 0) { EXPECT_LE(triangles_in(cell), kBudget / 2); }
    if (cell.level < cells->root_for(viewpoint).level) { EXPECT_GT(triangles_in(cell.parent()), kBudget / 2); }
  }
  EXPECT_GT(cells->fallback_cell(viewpoints()[2]).level, cells->fallback_cell(viewpoints()[0]).level);
}

TEST_F(CellTreeTest, LeavesDoNotDependOnTheOrderOfQuestions) {
  const auto forward = tree(), backward = tree();
  const std::vector<glm::dvec3> points = viewpoints();
  std::vector<CellId> first(points.size()), second(points.size());
  std::thread asker([&] {
    for (std::size_t k = 0; k < points.size(); ++k) first[k] = forward->leaf_at(points[k], nullptr).value();
  });
  for (std::size_t k = points.size(); k-- > 0;) second[k] = backward->leaf_at(points[k], nullptr).value();
  asker.join();
  EXPECT_EQ(first, second);
}

TEST_F(CellTreeTest, AViewerOutsideMakesTheRootGrow) {
  const auto cells = tree();
  EXPECT_TRUE(shells().grid.box(cells->scene_root()).contains(placed().scene->bounds()));
  for (const glm::dvec3& viewpoint : {glm::dvec3(5000, 2, 0), glm::dvec3(-70, -1e4, 3), glm::dvec3(1e6, 1e6, -1e6)}) {
    const CellId root = cells->root_for(viewpoint);
    EXPECT_GT(root.level, cells->scene_root().level);
    EXPECT_TRUE(cells->scene_root().is_within(root));
    EXPECT_TRUE(shells().grid.box(root).contains(viewpoint));
    const auto leaf = cells->leaf_at(viewpoint, nullptr);
    ASSERT_TRUE(leaf);
    EXPECT_TRUE(shells().grid.box(*leaf).contains(viewpoint));
  }
  EXPECT_EQ(cells->root_for(placed().at({0, 5, 0})), cells->scene_root());
}

TEST_F(CellTreeTest, ViewersBeyondTheLargestRootAreTakenForItsNearestPlace) {
  const auto cells = tree();
  const double inf = std::numeric_limits<double>::infinity(), nan = std::numeric_limits<double>::quiet_NaN();
  for (const glm::dvec3& viewpoint : {glm::dvec3(1e9, 2, 0), glm::dvec3(-1e12, -1e12, 1e12), glm::dvec3(inf, -inf, 0), glm::dvec3(nan, 1, nan)}) {
    const glm::dvec3 held = cells->on_grid(viewpoint);
    const CellId root = cells->root_for(viewpoint);
    EXPECT_TRUE(shells().grid.box(root).contains(held));
    EXPECT_TRUE(cells->scene_root().is_within(root));
    const auto leaf = cells->leaf_at(viewpoint, nullptr);
    ASSERT_TRUE(leaf);
    EXPECT_TRUE(leaf->is_within(root));
    EXPECT_TRUE(shells().grid.box(*leaf).contains(held));
  }
  const glm::dvec3 inside(4e7, -4e7, 3);
  EXPECT_EQ(cells->on_grid(inside), inside);
}

TEST_F(CellTreeTest, CancelledQuestionsFailAndLeaveNoTrace) {
  const auto cells = tree();
  const glm::dvec3 viewpoint = placed().at({21, 5.9, 21});
  const auto cancelled = std::make_shared<const std::atomic<bool>>(true);
  const auto refused = cells->leaf_at(viewpoint, cancelled);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kCancelled);
  const CellId leaf = cells->leaf_at(viewpoint, nullptr).value();
  EXPECT_EQ(leaf, tree()->leaf_at(viewpoint, nullptr).value());
  CellId other = leaf;
  ++other.y;
  const auto unseen = cells->visibility(other, cancelled);
  ASSERT_FALSE(unseen);
  EXPECT_EQ(unseen.error().code, ErrorCode::kCancelled);
}

}  // namespace
}  // namespace farfield
