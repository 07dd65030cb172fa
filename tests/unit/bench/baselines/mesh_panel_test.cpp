// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/baselines/mesh_panel.h"

#include <gtest/gtest.h>

#include <array>
#include <set>

#include "tests/unit/bench/baselines/far_scenes.h"

namespace farfield::bench {
namespace {

class MeshPanelTest : public testing::Test {
 protected:
  MeshPanelTest() {
    FarFace face = cast_far_face(room.scene(), room.space, room.centre(), 0, 98);
    panel = {face.frame, 0, rubber_sheet(face), face.rgb, {}};
    simplify(panel.mesh, 1e-3, 0.5);
  }
  test::PillarRoom room;
  MeshPanel panel;
  PanelEncoding encoding{90, 5e-4};
};

using Corner = std::array<long, 3>;
std::multiset<std::set<Corner>> triangles_of(const FaceMesh& mesh, double step) {
  std::multiset<std::set<Corner>> result;
  for (std::size_t t = 0; t + 2 < mesh.indices.size(); t += 3) {
    std::set<Corner> corners;
    for (std::size_t c = 0; c < 3; ++c) {
      const FaceVertex& v = mesh.vertices[mesh.indices[t + c]];
      corners.insert({std::lround(2 * v.column), std::lround(2 * v.row), std::lround(v.disparity / step)});
    }
    result.insert(corners);
  }
  return result;
}

TEST_F(MeshPanelTest, ComesBackWithinTheStep) {
  const EncodedPanel bytes = encode_panel(panel, encoding).value();
  const MeshPanel back = decode_panel(panel.frame, panel.face, bytes, encoding).value();
  EXPECT_EQ(triangles_of(back.mesh, encoding.disparity_step), triangles_of(panel.mesh, encoding.disparity_step));
  double off = 0;
  for (std::size_t k = 0; k < panel.rgb.size(); ++k) off += std::abs(int{back.rgb[k]} - int{panel.rgb[k]});
  EXPECT_LT(off / static_cast<double>(panel.rgb.size()), 3);
}

TEST_F(MeshPanelTest, BlocksNobodyNeedsAreNotSent) {
  panel.wanted.assign(13 * 13, 0);
  panel.wanted[5] = panel.wanted[20] = 1;
  const Bytes bytes = encode_image_blocks(panel.rgb, 98, panel.wanted, 90).value();
  EXPECT_LT(bytes.size(), encode_image_blocks(panel.rgb, 98, {}, 90).value().size() / 2);
  std::vector<std::uint8_t> rgb;
  const auto sent = decode_image_blocks(bytes, 98, 90, rgb).value();
  EXPECT_EQ(std::count(sent.begin(), sent.end(), 1), 2 * 64);
  EXPECT_TRUE(sent[40 + 7]);
  EXPECT_FALSE(sent[39]);
}

TEST_F(MeshPanelTest, BlocksUnderAMeshHoldItsFilteredTexels) {
  FaceMesh mesh;
  mesh.vertices = {{8, 8, 1}, {12, 8, 1}, {8, 12, 1}};  // begins on a block's edge: filtering reaches into the blocks before
  mesh.indices = {0, 1, 2};
  const auto blocks = blocks_under(mesh, 98);
  EXPECT_EQ(std::count(blocks.begin(), blocks.end(), 1), 4);
  EXPECT_TRUE(blocks[0] && blocks[1] && blocks[13] && blocks[14]);
}

TEST_F(MeshPanelTest, DamageGivesAnErrorOrAPicture) {
  const EncodedPanel whole = encode_panel(panel, encoding).value();
  for (std::size_t k = 0; k < whole.mesh.size(); k += 7) {
    EncodedPanel bad = whole;
    bad.mesh[k] ^= 0x55;
    if (const auto shown = decode_panel(panel.frame, panel.face, bad, encoding)) {
      for (const std::uint32_t index : shown->mesh.indices) ASSERT_LT(index, shown->mesh.vertices.size());
    }
    bad.mesh.resize(k);
    EXPECT_FALSE(k > 0 && decode_panel(panel.frame, panel.face, bad, encoding));
  }
}

TEST_F(MeshPanelTest, AnEmptyPanelCostsNothing) {
  panel.mesh = {};
  const EncodedPanel bytes = encode_panel(panel, encoding).value();
  EXPECT_EQ(bytes.size(), 0u);
  EXPECT_TRUE(decode_panel(panel.frame, panel.face, bytes, encoding).value().mesh.indices.empty());
}

}  // namespace
}  // namespace farfield::bench
