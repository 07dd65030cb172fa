// SPDX-License-Identifier: Apache-2.0
#include "common/net/outbox.h"

#include <gtest/gtest.h>

namespace farfield {
namespace {

OutgoingFrame frame(std::uint64_t tag, std::size_t payload = 84) {
  OutgoingFrame made = make_frame(MessageType::kTilePayload, {}, std::make_shared<Bytes>(payload));
  made.tag = tag;
  return made;
}

std::vector<std::uint64_t> tags(const std::vector<OutgoingFrame>& frames) {
  std::vector<std::uint64_t> result;
  for (const OutgoingFrame& f : frames) result.push_back(f.tag);
  return result;
}

TEST(Outbox, ControlOvertakesPayloadsAndPayloadsOvertakePrefetch) {
  Outbox outbox(1000, 1000);
  EXPECT_TRUE(outbox.push(frame(1), Lane::kPrefetch));
  EXPECT_TRUE(outbox.push(frame(2), Lane::kPayload));
  EXPECT_TRUE(outbox.push(frame(3), Lane::kPayload));
  EXPECT_TRUE(outbox.push(frame(4), Lane::kControl));
  EXPECT_EQ(outbox.bytes(), 400u);
  EXPECT_EQ(tags(outbox.take(10, 100000)), (std::vector<std::uint64_t>{4, 2, 3, 1}));
  EXPECT_TRUE(outbox.is_empty());
  EXPECT_EQ(outbox.bytes(), 0u);
}

TEST(Outbox, BudgetCountsBothPayloadLanesAndLetsOneLargeFrameThrough) {
  Outbox outbox(150, 1000);
  EXPECT_TRUE(outbox.push(frame(1, 100000), Lane::kPrefetch));
  EXPECT_FALSE(outbox.has_room());
  EXPECT_FALSE(outbox.push(frame(2), Lane::kPayload));
  EXPECT_TRUE(outbox.push(frame(3), Lane::kControl));
  EXPECT_EQ(outbox.take(10, 100000000).size(), 2u);
  EXPECT_TRUE(outbox.has_room());
}

TEST(Outbox, ControlHasABoundOfItsOwn) {
  Outbox outbox(1000, 150);
  EXPECT_TRUE(outbox.push(frame(1), Lane::kControl));
  EXPECT_TRUE(outbox.push(frame(2), Lane::kControl));
  EXPECT_FALSE(outbox.push(frame(3), Lane::kControl));
}

TEST(Outbox, TakesAtLeastOneAndNoMoreThanAsked) {
  Outbox outbox(10000, 1000);
  for (std::uint64_t i = 0; i < 6; ++i) ASSERT_TRUE(outbox.push(frame(i), Lane::kPayload));
  EXPECT_EQ(outbox.take(10, 1).size(), 1u);
  EXPECT_EQ(outbox.take(2, 10000).size(), 2u);
  EXPECT_EQ(outbox.take(10, 250).size(), 2u);
  EXPECT_EQ(tags(outbox.take(10, 10000)), (std::vector<std::uint64_t>{5}));
  EXPECT_TRUE(outbox.take(10, 10000).empty());
}

TEST(Outbox, DiscardNamesWhatWasDropped) {
  Outbox outbox(10000, 1000);
  ASSERT_TRUE(outbox.push(frame(7), Lane::kPayload));
  ASSERT_TRUE(outbox.push(frame(8), Lane::kPayload));
  ASSERT_TRUE(outbox.push(frame(9), Lane::kPrefetch));
  EXPECT_EQ(outbox.discard(Lane::kPayload), (std::vector<std::uint64_t>{7, 8}));
  EXPECT_EQ(outbox.bytes(), 100u);
  EXPECT_TRUE(outbox.discard(Lane::kPayload).empty());
}

}  // namespace
}  // namespace farfield
