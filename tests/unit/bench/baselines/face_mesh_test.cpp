// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/baselines/face_mesh.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "tests/unit/bench/baselines/far_scenes.h"

namespace farfield::bench {
namespace {

double area(const FaceMesh& mesh) {
  double sum = 0;
  for (std::size_t t = 0; t + 2 < mesh.indices.size(); t += 3) {
    const FaceVertex &a = mesh.vertices[mesh.indices[t]], &b = mesh.vertices[mesh.indices[t + 1]], &c = mesh.vertices[mesh.indices[t + 2]];
    sum += 0.5 * std::abs((b.column - a.column) * (c.row - a.row) - (c.column - a.column) * (b.row - a.row));
  }
  return sum;
}

/// The largest difference of disparity within one triangle.
float steepest(const FaceMesh& mesh) {
  float worst = 0;
  for (std::size_t t = 0; t + 2 < mesh.indices.size(); t += 3) {
    const auto disparity = [&](std::size_t corner) { return mesh.vertices[mesh.indices[t + corner]].disparity; };
    const auto [low, high] = std::minmax({disparity(0), disparity(1), disparity(2)});
    worst = std::max(worst, high - low);
  }
  return worst;
}

/// Samples of these pictures are coarse: the pillar's jump is seen under 2 degrees.
const SkinLimits kCoarse{5 * 3.14159265358979323846 / 180};

/// Pillar at z = 2.75 before the wall at z = 4, in 1/side.
constexpr float kJump = 1 / 2.75f - 1 / 4.0f;

class FaceMeshTest : public testing::Test {
 protected:
  test::PillarRoom room;
  FarFace face = cast_far_face(room.scene(), room.space, room.centre(), 0, 130);
  std::vector<std::uint8_t> all = std::vector<std::uint8_t>(face.covered.size(), 1);
};

TEST_F(FaceMeshTest, ARubberSheetSpansTheGapAndSquaresDoNot) {
  const FaceMesh sheet = rubber_sheet(face);
  EXPECT_NEAR(area(sheet), 129.0 * 129.0, 1e-3);
  EXPECT_NEAR(steepest(sheet), kJump, 0.02);
  const FaceMesh squares = surface_squares(face, connect_surfaces(face, {}, kCoarse), all);
  EXPECT_NEAR(area(squares), 130.0 * 130.0, 1e-3) << "every sample's whole square";
  EXPECT_LT(steepest(squares), 0.2 * kJump);
}

TEST_F(FaceMeshTest, SquaresOfAPlaneLieInIt) {
  const FaceMesh squares = surface_squares(face, connect_surfaces(face, {}, kCoarse), all);
  int checked = 0;
  for (const FaceVertex& v : squares.vertices) {
    const double u = face.frame.u(v.column - 0.5), w = face.frame.u(v.row - 0.5);
    const bool is_inner = v.column > 0 && v.row > 0 && v.column < 130 && v.row < 130;
    if (!is_inner || std::abs(u) > 0.8 || std::abs(w) > 0.8 || v.disparity > 0.3) continue;  // the wall behind, away from its edges
    EXPECT_NEAR(v.disparity, 0.25, 1e-4);
    ++checked;
  }
  EXPECT_GT(checked, 2000);
}

TEST_F(FaceMeshTest, OnlyWantedSamplesAreCovered) {
  std::vector<std::uint8_t> some(all.size(), 0);
  for (std::size_t k = 0; k < some.size(); k += 3) some[k] = 1;
  EXPECT_NEAR(area(surface_squares(face, connect_surfaces(face, {}, kCoarse), some)), static_cast<double>(std::accumulate(some.begin(), some.end(), 0)), 1e-3);
  EXPECT_TRUE(surface_squares(face, connect_surfaces(face, {}, kCoarse), std::vector<std::uint8_t>(all.size(), 0)).indices.empty());
}

TEST_F(FaceMeshTest, ASheetEndsOneSampleIntoTheSky) {
  for (int j = 0; j < 130; ++j)
    for (int i = 0; i < 130; ++i)
      if (i >= 50) face.covered[face.at(i, j)] = 0, face.disparity[face.at(i, j)] = 0;
  const FaceMesh sheet = rubber_sheet(face);
  EXPECT_NEAR(area(sheet), 50.0 * 129.0, 1e-3);
  EXPECT_LT(steepest(sheet), 1.1f * kJump) << "no sheet to infinity";
}

TEST_F(FaceMeshTest, SimplifyingLeavesFewTrianglesAndTheSameSurfaces) {
  FaceMesh mesh = surface_squares(face, connect_surfaces(face, {}, kCoarse), all);
  const std::size_t before = mesh.triangles();
  simplify(mesh, 1e-3, 0.5);
  EXPECT_LT(mesh.triangles() * 50, before);
  EXPECT_NEAR(area(mesh), 130.0 * 130.0, 0.01 * 130 * 130);
  EXPECT_LT(steepest(mesh), 0.6 * kJump) << "no triangle spans the gap, walls that run away aside";
}

}  // namespace
}  // namespace farfield::bench
