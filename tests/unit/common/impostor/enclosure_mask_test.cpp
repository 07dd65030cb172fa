// SPDX-License-Identifier: Apache-2.0
#include "common/impostor/enclosure_mask.h"

#include <gtest/gtest.h>

#include <functional>
#include <random>

namespace farfield {
namespace {

const Box kCell{glm::dvec3(-8, 16, 0), glm::dvec3(0, 24, 8)};

// The mask of what `is_inside` says of the centres of the 2^depth voxels along each edge.
EnclosureMask made_of(int depth, const std::function<bool(const glm::dvec3&)>& is_inside) {
  EnclosureMaskWriter writer;
  const std::function<void(glm::dvec3, double, int)> write = [&](glm::dvec3 low, double edge, int left) {
    if (left == 0) {
      writer.fill(is_inside(low + 0.5 * edge));
      return;
    }
    writer.divide();
    for (int child = 0; child < 8; ++child)
      write(low + 0.5 * edge * glm::dvec3(child & 1, child >> 1 & 1, child >> 2), 0.5 * edge, left - 1);
  };
  write(kCell.min, kCell.extent().x, depth);
  return EnclosureMask::from_bytes(writer.take()).value();
}

TEST(EnclosureMask, NoBytesAreTheWholeCell) {
  const EnclosureMask whole = EnclosureMask::from_bytes({}).value();
  EXPECT_TRUE(whole.is_whole());
  EXPECT_TRUE(whole.contains(kCell, kCell.center()));
  EXPECT_TRUE(whole.is_near(kCell, glm::dvec3(1e6)));
  EXPECT_EQ(whole, EnclosureMask());
}

TEST(EnclosureMask, HoldsTheVoxelsItWasMadeOf) {
  const auto ball = [](const glm::dvec3& p) { return glm::distance(p, kCell.center()) < 3; };
  std::mt19937 random(1);
  std::uniform_real_distribution<double> place(0, 8);
  for (const int depth : {0, 1, 3, 5}) {
    const EnclosureMask mask = made_of(depth, ball);
    const double edge = 8.0 / (1 << depth);
    for (int k = 0; k < 1000; ++k) {
      const glm::dvec3 offset(place(random), place(random), place(random));
      const glm::dvec3 middle = kCell.min + (glm::floor(offset / edge) + 0.5) * edge;
      EXPECT_EQ(mask.contains(kCell, kCell.min + offset), ball(middle));
    }
  }
}

TEST(EnclosureMask, BordersBelongToTheUpperVoxelAndOutsideTheNearestAnswers) {
  const EnclosureMask right = made_of(1, [](const glm::dvec3& p) { return p.x > -4; });
  EXPECT_TRUE(right.contains(kCell, {-4, 20, 4}));
  EXPECT_FALSE(right.contains(kCell, {std::nextafter(-4.0, -5.0), 20, 4}));
  EXPECT_TRUE(right.contains(kCell, {100, 20, 4}));
  EXPECT_FALSE(right.contains(kCell, {-100, 1e9, 4}));
}

TEST(EnclosureMask, NearIsAVoxelAwayAlongAnAxis) {
  const EnclosureMask right = made_of(3, [](const glm::dvec3& p) { return p.x > -4; });
  EXPECT_TRUE(right.is_near(kCell, {-4.5, 20, 4}));
  EXPECT_FALSE(right.is_near(kCell, {-5.5, 20, 4}));
}

TEST(EnclosureMask, MasksOfTheSameBytesAreEqual) {
  const auto low = [](const glm::dvec3& p) { return p.y < 20; };
  EXPECT_EQ(made_of(2, low), made_of(2, low));
  EXPECT_FALSE(made_of(2, low) == made_of(2, [&](const glm::dvec3& p) { return !low(p); }));
  EXPECT_FALSE(made_of(2, low) == EnclosureMask());
}

TEST(EnclosureMask, BytesThatAreNoOctreeAreRefused) {
  const auto refused = [](Bytes bytes) { return !EnclosureMask::from_bytes(bytes).has_value(); };
  EXPECT_FALSE(refused({0b10})) << "one voxel, inside";
  EXPECT_TRUE(refused({0b10, 0})) << "more than its octree";
  EXPECT_TRUE(refused({0b1})) << "divided, and no room for children";
  EXPECT_TRUE(refused(Bytes(4, 0xff))) << "divided for ever";
  EXPECT_TRUE(refused(Bytes(EnclosureMask::kMaxBytes + 1, 0)));
  const EnclosureMask low = made_of(3, [](const glm::dvec3& p) { return p.y < 20; });
  const Bytes cut(low.bytes().begin(), low.bytes().end() - 1);
  EXPECT_TRUE(refused(cut));
}

}  // namespace
}  // namespace farfield
