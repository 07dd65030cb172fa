// SPDX-License-Identifier: Apache-2.0
// How much of the view is there after so many bytes: a viewer who comes in is sent the fallback view, then the leaf set.
#include <gtest/gtest.h>

#include <algorithm>

#include "server/encode/tile_maker.h"
#include "server/model/generate.h"
#include "server/session/payload_order.h"
#include "tests/unit/server/session/fake_cell_service.h"

namespace farfield {
namespace {

struct Sent {
  TileId id;
  double bytes = 0, share = 0;
};

class ProgressiveOrder : public testing::Test {
 protected:
  void SetUp() override {
    scene = Scene::build(generate_model("city", 40000, 1).value()).value();
    ImpostorSettings settings;
    settings.display = {320, 180};
    settings.face_tiles = face_tiles_for(settings.display, settings.kappa);
    settings.near_triangles = 2000;
    made = make_impostor_sources(scene, settings);
    viewpoint = scene->bounds().center();
    viewpoint.y = 1.7 - scene->origin().y;
  }
  // The tiles of a plan in the order in which they are sent. What sends geometry is no matter of this test.
  std::vector<Sent> sent(const LeafPlan& plan) {
    LeafPlan tiles_only = plan;
    tiles_only.chunks.clear();
    std::vector<Sent> list;
    for (const PayloadItem& item : payload_order(test::FakeCellService(), tiles_only)) {
      const NeededTile& tile = plan.tiles[item.index];
      list.push_back({tile.id, static_cast<double>(made.tiles->make(tile.id, nullptr).value()->bytes->size()), tile.view_share});
    }
    return list;
  }
  // [k]: the share of what is seen that is there after k tenths of the bytes, whole tiles counted.
  static std::vector<double> curve(const std::vector<Sent>& list) {
    double all_bytes = 0, all_share = 0;
    for (const Sent& tile : list) all_bytes += tile.bytes, all_share += tile.share;
    std::vector<double> covered(11, 0);
    double bytes = 0, share = 0;
    for (const Sent& tile : list) {
      bytes += tile.bytes, share += tile.share;
      for (int tenth = 1; tenth <= 10; ++tenth)
        if (bytes <= tenth * all_bytes / 10 * (1 + 1e-12)) covered[static_cast<std::size_t>(tenth)] = share / all_share;
    }
    return covered;
  }

  std::shared_ptr<const Scene> scene;
  ImpostorSources made;
  glm::dvec3 viewpoint{0};
};

TEST_F(ProgressiveOrder, TheCoarseViewIsThereAfterASmallPartOfTheBytes) {
  const std::vector<Sent> coarse = sent(*made.leaves->fallback(viewpoint));
  const CellId leaf = made.leaves->leaf_at(viewpoint, nullptr).value();
  const std::vector<Sent> fine = sent(*made.leaves->plan(leaf, nullptr).value());
  double coarse_bytes = 0, coarse_share = 0, fine_bytes = 0;
  for (const Sent& tile : coarse) coarse_bytes += tile.bytes, coarse_share += tile.share;
  for (const Sent& tile : fine) fine_bytes += tile.bytes;
  EXPECT_NEAR(coarse_share, 1, 1e-5) << "all directions";
  EXPECT_LT(coarse_bytes, 0.2 * (coarse_bytes + fine_bytes));
  const std::vector<double> covered = curve(coarse);
  EXPECT_TRUE(std::is_sorted(covered.begin(), covered.end()));
}

TEST_F(ProgressiveOrder, EachShellBringsWhatCoversMostOfTheViewFirst) {
  const CellId leaf = made.leaves->leaf_at(viewpoint, nullptr).value();
  const std::vector<Sent> list = sent(*made.leaves->plan(leaf, nullptr).value());
  for (int level = leaf.level, judged = 0; level < leaf.level + 3; ++level) {
    std::vector<Sent> shell;
    std::copy_if(list.begin(), list.end(), std::back_inserter(shell), [&](const Sent& tile) { return tile.id.cell.level == level; });
    if (shell.size() < 30) {
      EXPECT_GE(judged, 1) << "the scene should fill a shell or two";
      break;
    }
    ++judged;
    const std::vector<double> covered = curve(shell);
    EXPECT_TRUE(std::is_sorted(covered.begin(), covered.end()));
    for (int tenth = 2; tenth <= 10; ++tenth) EXPECT_GE(covered[static_cast<std::size_t>(tenth)], 0.1 * tenth) << "shell " << level << ": later than if it came evenly";
    EXPECT_GE(covered[5], 0.6) << "shell " << level;
    // The view from the middle before what only shows past rims.
    EXPECT_TRUE(std::is_partitioned(shell.begin(), shell.end(), [](const Sent& tile) { return !tile.id.is_delta(); }));
    std::vector<Sent> backwards(shell.rbegin(), shell.rend());
    EXPECT_LT(curve(backwards)[5], 0.5) << "the order matters, and this tells";
  }
}

TEST_F(ProgressiveOrder, OuterShellsWhichOtherLeavesShareAreNotHeldUpByInnerOnes) {
  const CellId leaf = made.leaves->leaf_at(viewpoint, nullptr).value();
  const std::vector<Sent> list = sent(*made.leaves->plan(leaf, nullptr).value());
  EXPECT_TRUE(std::is_sorted(list.begin(), list.end(), [](const Sent& a, const Sent& b) { return a.id.cell.level > b.id.cell.level; }));
  EXPECT_GT(list.front().id.cell.level, leaf.level);
}

}  // namespace
}  // namespace farfield
