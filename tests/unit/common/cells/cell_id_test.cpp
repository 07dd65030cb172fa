// SPDX-License-Identifier: Apache-2.0
#include "common/cells/cell_id.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <random>
#include <unordered_set>

namespace farfield {
namespace {

const CellGrid kGrid{0.5};

glm::dvec3 random_point(std::mt19937& random, double range) {
  std::uniform_real_distribution<double> coordinate(-range, range);
  return {coordinate(random), coordinate(random), coordinate(random)};
}

bool is_same(double a, double b) {
  return std::memcmp(&a, &b, sizeof a) == 0;
}
bool is_same(const glm::dvec3& a, const glm::dvec3& b) {
  return is_same(a.x, b.x) && is_same(a.y, b.y) && is_same(a.z, b.z);
}

TEST(CellGrid, TheCellOfAPointHoldsItAtEveryLevel) {
  std::mt19937 random(1);
  for (int i = 0; i < 200; ++i) {
    const glm::dvec3 point = random_point(random, std::pow(10.0, i % 7));
    CellId cell = kGrid.cell_at(point, 0);
    for (int level = 0; level <= 20; ++level, cell = cell.parent()) {
      EXPECT_TRUE(kGrid.box(cell).contains(point));
      EXPECT_EQ(cell, kGrid.cell_at(point, level)) << "finding and climbing must agree";
    }
  }
}

TEST(CellGrid, AParentIsExactlyItsEightChildren) {
  std::mt19937 random(2);
  for (int i = 0; i < 100; ++i) {
    const CellId parent = kGrid.cell_at(random_point(random, 1e5), 1 + i % 18);
    const Box box = kGrid.box(parent);
    Box sum;
    for (int child = 0; child < 8; ++child) {
      const CellId id{static_cast<std::uint8_t>(parent.level - 1), 2 * parent.x + (child & 1),
                      2 * parent.y + (child >> 1 & 1), 2 * parent.z + (child >> 2)};
      EXPECT_EQ(id.parent(), parent);
      EXPECT_TRUE(id.is_within(parent));
      EXPECT_FALSE(parent.is_within(id));
      EXPECT_TRUE(box.contains(kGrid.box(id)));
      sum.include(kGrid.box(id));
    }
    EXPECT_TRUE(is_same(sum.min, box.min));
    EXPECT_TRUE(is_same(sum.max, box.max));
  }
}

TEST(CellGrid, NeighboursShareTheirBorderToTheLastBit) {
  std::mt19937 random(3);
  for (const double side : {0.001, 0.5, 0.3, 7.0}) {
    const CellGrid grid{side};
    for (int i = 0; i < 100; ++i) {
      const CellId cell = grid.cell_at(random_point(random, 1e6 * side), i % 12);
      CellId next = cell;
      ++next.x;
      EXPECT_TRUE(is_same(grid.box(cell).max.x, grid.box(next).min.x));
    }
  }
}

TEST(CellGrid, BordersAreHalfOpen) {
  std::mt19937 random(4);
  for (int i = 0; i < 100; ++i) {
    const CellId cell = kGrid.cell_at(random_point(random, 1e4), i % 10);
    const Box box = kGrid.box(cell);
    EXPECT_EQ(kGrid.cell_at(box.min, cell.level), cell) << "a lower corner belongs to its cell";
    const CellId above = kGrid.cell_at(box.max, cell.level);
    EXPECT_EQ(above, (CellId{cell.level, cell.x + 1, cell.y + 1, cell.z + 1})) << "an upper corner to the next";
    const glm::dvec3 just_inside{std::nextafter(box.max.x, -1e300), box.min.y, box.min.z};
    EXPECT_EQ(kGrid.cell_at(just_inside, cell.level), cell);
  }
}

TEST(CellGrid, SidesDoubleFromLevelToLevel) {
  EXPECT_DOUBLE_EQ(kGrid.side_m(0), 0.5);
  EXPECT_DOUBLE_EQ(kGrid.side_m(10), 512.0);
  const glm::dvec3 extent = kGrid.box(kGrid.cell_at({3, 4, 5}, 6)).extent();
  for (int axis = 0; axis < 3; ++axis) EXPECT_DOUBLE_EQ(extent[axis], 32.0);
}

TEST(CellGrid, AncestorsOfTheOriginGrowTowardsBothSides) {
  const CellId origin = kGrid.cell_at({0, 0, 0}, 0);
  for (const double reach_m : {1.0, 100.0, 1e4, 1e6}) {
    int level = 0;
    const auto holds_both = [&](const Box& box) {
      return box.contains({-reach_m, -reach_m, -reach_m}) && box.contains({reach_m, reach_m, reach_m});
    };
    while (level < kMaxCellLevel && !holds_both(kGrid.box(origin.ancestor(level)))) ++level;
    EXPECT_LT(level, kMaxCellLevel) << reach_m;
    // Not much larger than needed: growing alternates, so at most three doublings beyond the smallest cube.
    EXPECT_LE(kGrid.side_m(level), 2 * reach_m * 8) << reach_m;
  }
}

TEST(CellGrid, EnclosingIsTheSmallestCellThatHoldsTheBox) {
  std::mt19937 random(5);
  for (int i = 0; i < 100; ++i) {
    Box box;
    box.include(random_point(random, 1000));
    box.include(box.min + glm::abs(random_point(random, std::pow(4.0, i % 6))));
    const CellId cell = kGrid.enclosing(box);
    EXPECT_TRUE(kGrid.box(cell).contains(box));
    if (cell.level > 0) {
      EXPECT_FALSE(kGrid.box(kGrid.cell_at(box.min, cell.level - 1)).contains(box));
    }
  }
  EXPECT_EQ(kGrid.enclosing({{0.1, 0.1, 0.1}, {0.2, 0.2, 0.2}}, 5).level, 5);
}

TEST(CellGrid, PointsBeyondTheGridAreClampedIntoIt) {
  const CellId high = kGrid.cell_at({1e300, 1e300, 1e300}, 0);
  const CellId low = kGrid.cell_at({-1e300, -1e300, -1e300}, 0);
  EXPECT_EQ(low, (CellId{0, 0, 0, 0}));
  EXPECT_EQ(high.x, (1 << 30) - 1);
  EXPECT_TRUE(low.is_within(low.ancestor(kMaxCellLevel)));
}

TEST(CellId, AncestorsAreRepeatedParents) {
  const CellId cell = kGrid.cell_at({-12.3, 45.6, 7.8}, 0);
  CellId climbed = cell;
  for (int level = 1; level <= kMaxCellLevel; ++level) {
    climbed = climbed.parent();
    EXPECT_EQ(cell.ancestor(level), climbed);
  }
}

TEST(CellId, HashesOfCellsAroundOnePlaceDiffer) {
  std::unordered_set<std::size_t> hashes;
  for (int level = 0; level < 4; ++level) {
    const CellId origin = kGrid.cell_at({0, 0, 0}, level);
    for (int i = 0; i < 1000; ++i) {
      hashes.insert(std::hash<CellId>()({origin.level, origin.x + i % 10, origin.y + i / 10 % 10, origin.z + i / 100}));
    }
  }
  EXPECT_EQ(hashes.size(), 4000u);
}

}  // namespace
}  // namespace farfield
