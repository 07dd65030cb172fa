// SPDX-License-Identifier: Apache-2.0
#include "client/store/leaf_sets.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/cells/nested_shells.h"
#include "tests/unit/client/store/made_leaf_sets.h"

namespace farfield::client {
namespace {

using ::testing::IsEmpty;
using ::testing::UnorderedElementsAre;

class LeafSetsTest : public ::testing::Test {
 protected:
  void show(std::uint64_t serial, int leaf, std::vector<ContentHash> tiles) {
    sets.set_eye(made::eye_in(leaf));
    sets.announce(made::leaf_set(serial, leaf, tiles));
    for (const ContentHash key : tiles) sets.receive(made::tile(key));
    sets.update(true);
    ASSERT_EQ(sets.view()->leaf, made::leaf_at(leaf));
    ASSERT_TRUE(sets.view()->is_complete);
  }
  bool shows(int leaf) const { return sets.view() && sets.view()->leaf == made::leaf_at(leaf); }

  LeafSets sets{made::frame(), 1 << 20};
};

TEST_F(LeafSetsTest, NothingIsShownBeforeAnythingHasArrived) {
  sets.set_eye(made::eye_in(0));
  EXPECT_FALSE(sets.update(true));
  sets.announce(made::leaf_set(1, 0, {1, 2}));
  EXPECT_FALSE(sets.update(true));
  EXPECT_EQ(sets.view(), nullptr);
  EXPECT_TRUE(is_late(sets.view().get(), made::eye_in(0)));
}

TEST_F(LeafSetsTest, TheFirstSetIsShownAsItComes) {
  sets.set_eye(made::eye_in(0));
  sets.announce(made::leaf_set(1, 0, {1, 2}));
  sets.receive(made::tile(1));
  EXPECT_TRUE(sets.update(false));
  EXPECT_EQ(sets.view()->tiles.size(), 1u);
  EXPECT_FALSE(sets.view()->is_complete);
  EXPECT_TRUE(is_late(sets.view().get(), made::eye_in(0)));
  sets.receive(made::tile(2));
  EXPECT_TRUE(sets.update(false)) << "completion is not put off";
  EXPECT_TRUE(sets.view()->is_complete);
  EXPECT_FALSE(is_late(sets.view().get(), made::eye_in(0)));
}

TEST_F(LeafSetsTest, SwitchesWholeAndOnlyWhenComplete) {
  show(1, 0, {1, 2});
  sets.set_eye(made::eye_in(1));
  sets.announce(made::leaf_set(2, 1, {2, 3, 4}));
  for (const ContentHash key : {3}) {
    sets.receive(made::tile(key));
    sets.update(true);
    EXPECT_TRUE(shows(0));
    EXPECT_TRUE(sets.view()->is_complete);
  }
  EXPECT_TRUE(is_late(sets.view().get(), made::eye_in(1)));
  sets.receive(made::tile(4));
  EXPECT_TRUE(sets.update(false));
  EXPECT_TRUE(shows(1));
  EXPECT_EQ(sets.view()->tiles.size(), 3u);
}

TEST_F(LeafSetsTest, APrefetchedSetIsShownTheMomentTheEyeEnters) {
  show(1, 0, {1});
  sets.announce(made::leaf_set(2, 1, {2}, /*is_current=*/false));
  sets.receive(made::tile(2));
  EXPECT_FALSE(sets.update(true));
  EXPECT_TRUE(shows(0)) << "the eye is elsewhere still";
  sets.set_eye(made::eye_in(1));
  EXPECT_TRUE(sets.update(false));
  EXPECT_TRUE(shows(1));
  EXPECT_FALSE(is_late(sets.view().get(), made::eye_in(1)));
}

TEST_F(LeafSetsTest, BehindAWallTheSetOfTheOtherSideIsNotEnough) {
  const glm::dvec3 low(0.1, 0.5, 0.5), high(0.9, 0.5, 0.5);
  sets.set_eye(low);
  sets.announce(made::half_set(1, 0, false, {1, 2}));
  for (const ContentHash key : {1, 2}) sets.receive(made::tile(key));
  EXPECT_TRUE(sets.update(true));
  EXPECT_FALSE(is_late(sets.view().get(), low));
  EXPECT_TRUE(sets.has_usable_view());
  // Through the wall, in the same leaf.
  sets.set_eye(high);
  EXPECT_TRUE(is_late(sets.view().get(), high));
  sets.announce(made::half_set(2, 0, true, {2, 3}));
  sets.update(true);
  EXPECT_TRUE(is_late(sets.view().get(), high));
  sets.receive(made::tile(3));
  EXPECT_TRUE(sets.update(false));
  EXPECT_FALSE(is_late(sets.view().get(), high));
  EXPECT_EQ(sets.view()->tiles.size(), 2u);
  // Both are kept: back again nothing has to come.
  sets.set_eye(low);
  EXPECT_TRUE(sets.update(false));
  EXPECT_FALSE(is_late(sets.view().get(), low));
}

TEST_F(LeafSetsTest, FarBehindAWallASetIsOfNoUse) {
  sets.set_eye({0.1, 0.5, 0.5});
  LeafSet quarter = made::half_set(1, 0, false, {1});
  EnclosureMaskWriter writer;
  writer.divide();
  for (int child = 0; child < 8; ++child) {
    writer.divide();
    for (int part = 0; part < 8; ++part) writer.fill(child % 2 == 0 && part % 2 == 0);
  }
  quarter.enclosure = EnclosureMask::from_bytes(writer.take()).value();
  sets.announce(std::move(quarter));
  sets.receive(made::tile(1));
  sets.update(true);
  EXPECT_TRUE(sets.has_usable_view());
  sets.set_eye({0.3, 0.5, 0.5});
  EXPECT_TRUE(sets.has_usable_view()) << "in the voxel beside it, which holds the wall";
  sets.set_eye({0.8, 0.5, 0.5});
  EXPECT_FALSE(sets.has_usable_view());
}

TEST_F(LeafSetsTest, CompleteWaitsForChunksAndTheCoarsestTextureLevels) {
  LeafSet set = made::leaf_set(1, 0, {1});
  set.chunks = {{20, 30}, {21, 0}, {20, 30}};
  sets.set_eye(made::eye_in(0));
  sets.announce(set);
  sets.receive(made::tile(1));
  sets.receive(made::chunk(20));
  sets.receive(made::chunk(21));
  sets.update(true);
  EXPECT_FALSE(sets.view()->is_complete);
  sets.receive(made::texture_level(30, 3, 2));
  sets.update(false);
  EXPECT_TRUE(sets.view()->is_complete);
  ASSERT_EQ(sets.view()->chunks.size(), 3u);
  const auto coarse = sets.view()->chunks[0].texture;
  EXPECT_EQ(sets.view()->chunks[1].texture, nullptr);
  // Finer levels refine in place: a new snapshot, when the caller allows one.
  sets.receive(made::texture_level(30, 2, 4));
  EXPECT_FALSE(sets.update(false));
  EXPECT_TRUE(sets.needs_refinement());
  EXPECT_TRUE(sets.update(true));
  EXPECT_NE(sets.view()->chunks[0].texture->serial, coarse->serial);
  EXPECT_EQ(sets.view()->chunks[0].texture->levels.size(), 2u);
}

TEST_F(LeafSetsTest, ABadPayloadDoesNotHoldTheSetUp) {
  sets.set_eye(made::eye_in(0));
  sets.announce(made::leaf_set(1, 0, {1, 2}));
  sets.receive(made::tile(1));
  sets.abandon({PayloadKind::kTile, 2, 0, 0});
  sets.update(true);
  EXPECT_TRUE(sets.view()->is_complete);
  EXPECT_EQ(sets.view()->tiles.size(), 1u);
  EXPECT_THAT(sets.take_evicted(), IsEmpty()) << "reported now, it would be sent again for ever";
  // The next set that needs it asks for it again.
  sets.set_eye(made::eye_in(1));
  sets.announce(made::leaf_set(2, 1, {2}));
  EXPECT_THAT(sets.take_evicted(), UnorderedElementsAre(2));
}

TEST_F(LeafSetsTest, AnEmptyTileCountsAsHeld) {
  sets.set_eye(made::eye_in(0));
  sets.announce(made::leaf_set(1, 0, {1, 2}));
  sets.receive(made::tile(1));
  sets.receive_empty({PayloadKind::kTile, 2, 0, 0});
  sets.update(true);
  EXPECT_TRUE(sets.view()->is_complete);
  EXPECT_EQ(sets.view()->tiles.size(), 1u);
  EXPECT_THAT(sets.store().held_payloads(10), UnorderedElementsAre(1, 2));
}

TEST_F(LeafSetsTest, OpenSkyIsShownAsSuch) {
  show(1, 0, {1});
  sets.set_eye(made::eye_in(1));
  sets.announce(made::leaf_set(2, 1, {2}));
  sets.receive_empty({PayloadKind::kTile, 2, 0, 0});
  sets.update(true);
  EXPECT_TRUE(shows(1));
  EXPECT_TRUE(sets.view()->tiles.empty());
  sets.set_eye(made::eye_in(2));
  sets.announce(made::leaf_set(3, 2, {}));  // nothing to draw at all
  sets.update(true);
  EXPECT_TRUE(shows(2));
}

TEST_F(LeafSetsTest, ASetOfWhichNothingDecodesLeavesTheLastPicture) {
  show(1, 0, {1});
  sets.set_eye(made::eye_in(1));
  sets.announce(made::leaf_set(2, 1, {2}));
  sets.abandon({PayloadKind::kTile, 2, 0, 0});
  sets.update(true);
  EXPECT_TRUE(shows(0));
  EXPECT_FALSE(sets.view()->tiles.empty());
}

TEST_F(LeafSetsTest, TheOldSetServesOneSideOutsideThenTheFallbackTakesOver) {
  show(1, 0, {1});
  sets.set_eye(made::eye_in(1));  // half a side outside
  sets.announce(made::fallback_set(2, 1, {7}));
  sets.receive(made::tile(7));
  sets.update(true);
  EXPECT_TRUE(shows(0));
  EXPECT_TRUE(sets.has_usable_view());

  sets.set_eye(made::eye_in(30));
  EXPECT_FALSE(sets.has_usable_view());
  sets.update(true);
  EXPECT_TRUE(shows(0)) << "nothing better is here: a set is worth more than a fallback view as far away";
  sets.announce(made::fallback_set(3, 30, {8, 9}));
  sets.receive(made::tile(8));
  sets.update(true);
  EXPECT_FALSE(shows(30)) << "half a fallback view is no view";
  sets.receive(made::tile(9));
  sets.update(true);
  ASSERT_TRUE(shows(30));
  EXPECT_TRUE(sets.view()->is_fallback);
  EXPECT_TRUE(sets.has_usable_view());
  EXPECT_TRUE(is_late(sets.view().get(), made::eye_in(30)));
  EXPECT_EQ(sets.view()->near_region.min.x, sets.view()->leaf_box.min.x - NestedShells::kFallbackKappa);

  sets.announce(made::leaf_set(4, 30, {10}));
  sets.receive(made::tile(10));
  sets.update(true);
  EXPECT_TRUE(shows(30));
  EXPECT_FALSE(sets.view()->is_fallback);
  EXPECT_LT(sets.view()->near_region.min.x, sets.view()->leaf_box.min.x - 1.9);
}

TEST_F(LeafSetsTest, ASetThatCompletesAfterItsLeafWasLeftIsShownWhenItIsNearer) {
  show(1, 0, {1});
  sets.set_eye(made::eye_in(1));
  sets.announce(made::leaf_set(2, 1, {2}));
  sets.set_eye(made::eye_in(2));
  sets.announce(made::leaf_set(3, 2, {3}));
  sets.update(true);
  EXPECT_TRUE(shows(0));
  sets.receive(made::tile(2));
  EXPECT_TRUE(sets.update(false));
  EXPECT_TRUE(shows(1)) << "half a side away instead of one and a half";
  EXPECT_TRUE(is_late(sets.view().get(), made::eye_in(2)));
  sets.receive(made::tile(3));
  sets.update(false);
  EXPECT_TRUE(shows(2));
}

TEST_F(LeafSetsTest, AWalkAlongABorderDoesNotSwitchToAndFro) {
  show(1, 0, {1});
  sets.announce(made::leaf_set(2, 2, {2}, false));
  sets.receive(made::tile(2));
  for (const double x : {1.45, 1.55, 1.45, 1.55}) {  // between leaves 0 and 2, and in neither
    sets.set_eye({x, 0.5, 0.5});
    sets.update(true);
    EXPECT_TRUE(shows(0)) << x;
  }
  sets.set_eye({1.7, 0.5, 0.5});
  sets.update(true);
  EXPECT_TRUE(shows(2));
}

TEST_F(LeafSetsTest, AnotherFallbackViewIsWantedOnceTheEyeHasLeftTheLeafOfThisOne) {
  sets.set_eye(made::eye_in(0));
  sets.announce(made::fallback_set(1, 0, {7}));
  sets.receive(made::tile(7));
  sets.update(true);
  EXPECT_TRUE(sets.has_usable_view());
  sets.set_eye({1.2, 0.5, 0.5});
  EXPECT_TRUE(sets.has_usable_view());
  sets.set_eye({1.3, 0.5, 0.5});
  EXPECT_FALSE(sets.has_usable_view());
}

TEST_F(LeafSetsTest, OnceSomethingIsShownThereIsAlwaysSomething) {
  show(1, 0, {1});
  for (int leaf = 1; leaf < 200; leaf += 7) {
    sets.set_eye(made::eye_in(leaf));
    sets.announce(made::leaf_set(static_cast<std::uint64_t>(leaf) + 1, leaf, {1000u + leaf}));
    sets.update(true);
    ASSERT_NE(sets.view(), nullptr);
    EXPECT_FALSE(sets.view()->tiles.empty());
  }
}

TEST_F(LeafSetsTest, EyesOnABorderBelongToTheUpperLeaf) {
  show(1, 0, {1});
  sets.announce(made::leaf_set(2, 1, {2}, false));
  sets.receive(made::tile(2));
  sets.set_eye({1.0, 0.5, 0.5});
  sets.update(true);
  EXPECT_TRUE(shows(1));
}

TEST_F(LeafSetsTest, EvictionsOfPrefetchedSetsAreReportedAndNoticed) {
  LeafSets small(made::frame(), 3 * made::kTileBytes);
  small.set_eye(made::eye_in(0));
  small.announce(made::leaf_set(1, 0, {1, 2}));
  small.receive(made::tile(1));
  small.receive(made::tile(2));
  small.update(true);
  small.announce(made::leaf_set(2, 1, {3}, false));
  small.receive(made::tile(3));
  small.announce(made::leaf_set(3, -1, {4}, false));
  small.receive(made::tile(4));
  EXPECT_THAT(small.take_evicted(), UnorderedElementsAre(3));
  small.set_eye(made::eye_in(1));
  small.update(true);
  EXPECT_EQ(small.view()->leaf, made::leaf_at(0)) << "leaf 1 is no longer complete";
  EXPECT_EQ(small.view()->tiles.size(), 2u) << "what is shown is pinned";
}

TEST_F(LeafSetsTest, PrefetchedPayloadsNeverDisplaceWhatIsShown) {
  LeafSets small(made::frame(), 2 * made::kTileBytes);
  small.set_eye(made::eye_in(0));
  small.announce(made::leaf_set(1, 0, {1, 2}));
  small.receive(made::tile(1));
  small.receive(made::tile(2));
  small.update(true);
  small.announce(made::leaf_set(2, 1, {3}, false));
  small.receive(made::tile(3));
  EXPECT_THAT(small.take_evicted(), UnorderedElementsAre(3));
  small.update(true);
  EXPECT_EQ(small.view()->tiles.size(), 2u);
}

TEST_F(LeafSetsTest, GroupsFollowWhatTheEyeNeeds) {
  show(1, 0, {1});
  sets.announce(made::leaf_set(2, 1, {2}, false));
  const PayloadName prefetched{PayloadKind::kTile, 2, 0, 0};
  EXPECT_EQ(sets.group_of(prefetched), DecodeGroup::kPrefetch);
  const std::uint64_t version = sets.roles_version();
  sets.set_eye(made::eye_in(1));
  sets.update(true);
  EXPECT_EQ(sets.group_of(prefetched), DecodeGroup::kNeeded);
  EXPECT_NE(sets.roles_version(), version);
}

}  // namespace
}  // namespace farfield::client
