// SPDX-License-Identifier: Apache-2.0
// The nested shells tile space: every point belongs to exactly one part, for any viewer, any scale and any margin.
#include "common/cells/nested_shells.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace farfield {
namespace {

// Power-of-two sides and dyadic margins: what the system uses, and where every border is an exact double. Ranges stay
// within the reach of the largest root, which begins 2^28/3 finest sides below the origin (87 km for sides of 2^-10 m).
struct Setting {
  double finest_side_m, kappa, range_m;  // viewers lie within ±range_m on each axis
};
const Setting kSettings[] = {{0.5, 2.0, 10.0},     {0.5, 2.0, 1e6},         {2.0, 1.0, 1e7},
                             {0.25, 1.5, 3000.0},  {0x1p-10, 2.0, 1.0},     {0x1p-10, 3.0, 8e4}};

class Places {
 public:
  Places(const Setting& setting, unsigned seed) : setting_(setting), random_(seed) {}

  double uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }
  int below(int count) { return std::uniform_int_distribution<int>(0, count - 1)(random_); }

  /// Every other viewer stands exactly on a border of cells, on some of the axes.
  glm::dvec3 viewer() {
    glm::dvec3 point;
    for (int axis = 0; axis < 3; ++axis) {
      point[axis] = uniform(-setting_.range_m, setting_.range_m);
      const double side = std::ldexp(setting_.finest_side_m, below(8));
      if (below(2)) point[axis] = std::floor(point[axis] / side) * side;
    }
    return point;
  }
  /// Near the box, each coordinate either free, on a face of it, or the last double before a face.
  glm::dvec3 around(const Box& box) {
    glm::dvec3 point;
    for (int axis = 0; axis < 3; ++axis) {
      const double extent = box.max[axis] - box.min[axis];
      point[axis] = uniform(box.min[axis] - extent, box.max[axis] + extent);
      const double face = below(2) ? box.min[axis] : box.max[axis];
      const int kind = below(4);
      if (kind == 1) point[axis] = face;
      if (kind == 2) point[axis] = std::nextafter(face, -1e300);
    }
    return point;
  }

 private:
  const Setting& setting_;
  std::mt19937 random_;
};

// The parts of a leaf set that hold `point`, straight from the definition: near region, shell of each cell, root's shell.
std::vector<int> parts_that_hold(const NestedShells& shells, const CellId& leaf, const CellId& root, const glm::dvec3& point) {
  std::vector<int> parts;
  if (shells.near_region(leaf).contains(point)) parts.push_back(NestedShells::kNear);
  for (int level = leaf.level; level <= root.level; ++level) {
    const bool is_inside = shells.near_region(leaf.ancestor(level)).contains(point);
    const bool is_beyond = level < root.level && !shells.near_region(leaf.ancestor(level + 1)).contains(point);
    if (!is_inside && !is_beyond) parts.push_back(level);
  }
  return parts;
}

TEST(NestedShells, EveryPointBelongsToExactlyOnePart) {
  for (const Setting& setting : kSettings) {
    const NestedShells shells{CellGrid{setting.finest_side_m}, setting.kappa};
    Places places(setting, 11);
    for (int viewer = 0; viewer < 150; ++viewer) {
      const CellId leaf = shells.grid.cell_at(places.viewer(), places.below(6));
      const CellId root = leaf.ancestor(leaf.level + places.below(8));
      for (int k = 0; k < 60; ++k) {
        const CellId ancestor = leaf.ancestor(leaf.level + places.below(root.level - leaf.level + 1));
        const glm::dvec3 point = places.around(places.below(3) ? shells.near_region(ancestor) : shells.grid.box(ancestor));
        const std::vector<int> parts = parts_that_hold(shells, leaf, root, point);
        ASSERT_EQ(parts.size(), 1u) << "side " << setting.finest_side_m << ", point " << point.x << ' ' << point.y << ' ' << point.z;
        ASSERT_EQ(shells.shell_at(leaf, root, point), parts[0]) << "shell_at must agree with the boxes";
      }
    }
  }
}

TEST(NestedShells, ANearRegionLiesWellInsideItsParents) {
  for (const Setting& setting : kSettings) {
    const NestedShells shells{CellGrid{setting.finest_side_m}, setting.kappa};
    Places places(setting, 12);
    for (int k = 0; k < 400; ++k) {
      const CellId cell = shells.grid.cell_at(places.viewer(), places.below(10));
      const Box inner = shells.near_region(cell), outer = shells.near_region(cell.parent());
      const double margin = setting.kappa * shells.grid.side_m(cell.level);
      for (int axis = 0; axis < 3; ++axis) {
        ASSERT_GE(inner.min[axis] - outer.min[axis], margin);
        ASSERT_GE(outer.max[axis] - inner.max[axis], margin);
      }
    }
  }
}

TEST(NestedShells, TheNearRegionKeepsItsMarginToEveryViewerOfTheCell) {
  for (const Setting& setting : kSettings) {
    const NestedShells shells{CellGrid{setting.finest_side_m}, setting.kappa};
    Places places(setting, 13);
    for (int k = 0; k < 400; ++k) {
      const glm::dvec3 viewer = places.viewer();
      const CellId cell = shells.grid.cell_at(viewer, places.below(10));
      ASSERT_TRUE(shells.grid.box(cell).contains(viewer));
      const glm::dvec3 point = places.around(shells.near_region(cell));
      if (shells.shell_at(cell, cell, point) == NestedShells::kNear) continue;
      const glm::dvec3 away = glm::abs(point - viewer);
      // One unit in the last place of the viewer's coordinate: points one double below a face lie that much closer.
      const double ulp = std::nextafter(setting.range_m, 1e300) - setting.range_m;
      ASSERT_GE(std::max({away.x, away.y, away.z}), setting.kappa * shells.grid.side_m(cell.level) - 2 * ulp);
    }
  }
}

TEST(NestedShells, ARootGrownByDoublingHoldsAnyViewer) {
  for (const Setting& setting : kSettings) {
    const CellGrid grid{setting.finest_side_m};
    Places places(setting, 14);
    for (int k = 0; k < 200; ++k) {
      Box scene;
      scene.include(places.viewer());
      scene.include(scene.min + glm::dvec3(places.uniform(0, 50), places.uniform(0, 20), places.uniform(0, 50)) * setting.finest_side_m);
      CellId root = grid.enclosing(scene);
      ASSERT_TRUE(grid.box(root).contains(scene));
      const glm::dvec3 viewer = places.viewer();
      while (root.level < kMaxCellLevel && !grid.box(root).contains(viewer)) {
        const Box before = grid.box(root);
        root = root.parent();
        ASSERT_TRUE(grid.box(root).contains(before));
      }
      ASSERT_TRUE(grid.box(root).contains(viewer)) << "side " << setting.finest_side_m;
      ASSERT_TRUE(grid.box(root).contains(scene));
    }
  }
}

}  // namespace
}  // namespace farfield
