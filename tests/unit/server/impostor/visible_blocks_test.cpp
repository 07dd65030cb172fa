// SPDX-License-Identifier: Apache-2.0
#include "server/impostor/visible_blocks.h"

#include <gtest/gtest.h>

#include <random>

#include "tests/unit/server/impostor/block_scenes.h"

namespace farfield {
namespace {

const int kEdge = face_samples(3);

CellSpace cell_at_origin() {
  CellSpace space{CellId{}, test::cube(glm::dvec3(0), 1.0), 1.0, {}};
  space.shell.inside = space.box.grown(2.0);
  space.shell.outside = space.box.grown(4.5);
  return space;
}

// The sample of the view's face nearest to a point.
struct Place {
  int face, i, j;
};
Place place_of(const glm::dvec3& view, const glm::dvec3& point) {
  const glm::dvec3 direction = point - view;
  const int face = dominant_face(direction);
  const CubeFace frame = CubeFace::of(face);
  const double z = std::abs(direction[frame.axis]);
  const auto sample = [&](int axis) { return std::clamp(static_cast<int>(std::lround(sample_index(kEdge, direction[axis] / z))), 0, kEdge - 1); };
  return {face, sample(frame.u_axis()), sample(frame.v_axis())};
}

TEST(VisibleBlocks, HoldEveryBlockThatAFarHitFallsInto) {
  const CellSpace space = cell_at_origin();
  std::mt19937 random(1);
  std::uniform_real_distribution<float> place(-4.9f, 4.9f);
  BoxVisibility seen;
  for (int k = 0; k < 300; ++k) seen.far_hits.push_back({{place(random), place(random), place(random)}, 1e-3f});
  for (const glm::dvec3& view : {glm::dvec3(0), glm::dvec3(0.5, -0.5, 0.25)}) {
    const VisibleBlocks blocks(points_in_shell(seen, space), view, kEdge);
    int inside = 0;
    for (const FarHit& hit : seen.far_hits) {
      if (!space.contains(glm::dvec3(hit.point))) continue;
      const Place at = place_of(view, glm::dvec3(hit.point));
      EXPECT_TRUE(blocks.contains(at.face, at.i, at.j));
      ++inside;
    }
    EXPECT_GT(inside, 100);
    EXPECT_LT(blocks.visible(), blocks.size());
  }
}

TEST(VisibleBlocks, GrowByTwoBlocksAroundAHit) {
  BoxVisibility seen;
  seen.far_hits.push_back({{3, 0.1f, 0.2f}, 1e-3f});
  const VisibleBlocks blocks(points_in_shell(seen, cell_at_origin()), glm::dvec3(0), kEdge);
  EXPECT_EQ(blocks.visible(), 25u);
  const Place at = place_of(glm::dvec3(0), {3, 0.1, 0.2});
  EXPECT_TRUE(blocks.contains(at.face, at.i - 2 * kBlockSamples, at.j + 2 * kBlockSamples));
  EXPECT_FALSE(blocks.contains(at.face, at.i - 3 * kBlockSamples, at.j));
  EXPECT_FALSE(blocks.contains(1, at.i, at.j)) << "the opposite face";
}

TEST(VisibleBlocks, HitsOutsideTheShellCountForNothing) {
  BoxVisibility seen;
  seen.far_hits.push_back({{2, 0, 0}, 1e-3f});  // near
  seen.far_hits.push_back({{0, 9, 0}, 1e-3f});  // the parent's shell
  EXPECT_TRUE(points_in_shell(seen, cell_at_origin()).empty());
  EXPECT_EQ(VisibleBlocks({}, glm::dvec3(0), kEdge).visible(), 0u);
}

}  // namespace
}  // namespace farfield
