// SPDX-License-Identifier: Apache-2.0
#include "common/impostor/packed_mesh.h"

#include <gtest/gtest.h>

#include <cstring>

namespace farfield {
namespace {

DepthMesh some_mesh() {
  DepthMesh mesh;
  mesh.face = 3, mesh.width = 40, mesh.height = 24, mesh.has_gaps = true;
  for (int i = 0; i < 40 * 24; ++i) {
    const bool is_gap = i % 40 > 12;
    for (int c = 0; c < 3; ++c) mesh.rgb.push_back(is_gap ? 0 : static_cast<std::uint8_t>(i * 37 + c));
    mesh.cuts.push_back(is_gap ? 0 : static_cast<std::uint8_t>(i % 9));
  }
  for (int i = 0; i < 300; ++i) {
    const auto x = static_cast<float>(i);
    mesh.vertices.push_back({-0.01f * x, 1.0f / (x + 3), 0.25f * x, x / 16, 24 - x / 32});
    for (const int k : {0, 1, 7}) mesh.indices.push_back(static_cast<std::uint32_t>((i + k) % 300));
  }
  return mesh;
}

TEST(PackedMesh, UnpacksToTheSameMeshBitForBit) {
  const DepthMesh mesh = some_mesh();
  const PackedMesh packed(mesh);
  const DepthMesh again = packed.unpack();
  EXPECT_EQ(again.face, mesh.face);
  EXPECT_EQ(again.width, mesh.width);
  EXPECT_EQ(again.height, mesh.height);
  EXPECT_EQ(again.has_gaps, mesh.has_gaps);
  EXPECT_EQ(again.rgb, mesh.rgb);
  EXPECT_EQ(again.cuts, mesh.cuts);
  EXPECT_EQ(again.indices, mesh.indices);
  ASSERT_EQ(again.vertices.size(), mesh.vertices.size());
  EXPECT_EQ(std::memcmp(again.vertices.data(), mesh.vertices.data(), mesh.vertices.size() * sizeof(DepthMeshVertex)), 0);
  EXPECT_LT(packed.memory_bytes(), packed.unpacked_bytes() * 2 / 3);
  EXPECT_FALSE(packed.is_empty());
}

TEST(PackedMesh, OfNothingIsNothing) {
  for (const PackedMesh& packed : {PackedMesh(), PackedMesh(DepthMesh())}) {
    EXPECT_TRUE(packed.is_empty());
    EXPECT_EQ(packed.unpacked_bytes(), 0u);
    EXPECT_TRUE(packed.unpack().vertices.empty());
  }
}

}  // namespace
}  // namespace farfield
