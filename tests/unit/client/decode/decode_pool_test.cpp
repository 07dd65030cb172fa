// SPDX-License-Identifier: Apache-2.0
#include "client/decode/decode_pool.h"

#include <gtest/gtest.h>

#include <future>
#include <new>

namespace farfield::client {
namespace {

/// A pool whose tile decoder waits until it is let go and then fails, so that the order of results is the order of
/// decoding.
class DecodePoolTest : public ::testing::Test {
 protected:
  void make_pool(int threads) {
    PayloadDecoder gated(CellGrid{0.5}, DecodeForm::kMesh, [open = open_](ByteView) -> Result<Tile> {
      open.wait();
      return fail(ErrorCode::kBadData, "no tile");
    });
    pool_ = std::make_unique<DecodePool>(std::move(gated), threads,
                                         [this](const PayloadName& name, Result<DecodedPayload> result) {
                                           const std::lock_guard lock(mutex_);
                                           EXPECT_FALSE(result);
                                           order_.push_back(name.key);
                                           changed_.notify_all();
                                         });
  }
  void submit(ContentHash key, DecodeGroup group, std::size_t bytes = 1) {
    pool_->submit({{PayloadKind::kTile, key, 0, 0}, std::make_shared<const Bytes>(bytes)}, group);
  }
  /// Until the only thread is busy with the first payload, so that the rest waits.
  void wait_until_taken(std::size_t left_bytes) {
    while (pool_->queued_bytes() > left_bytes) std::this_thread::yield();
  }
  void let_go() { gate_.set_value(); }
  std::vector<ContentHash> wait_for(std::size_t count) {
    std::unique_lock lock(mutex_);
    EXPECT_TRUE(changed_.wait_for(lock, std::chrono::seconds(5), [&] { return order_.size() >= count; }));
    return order_;
  }

  std::promise<void> gate_;
  std::shared_future<void> open_ = gate_.get_future().share();
  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<ContentHash> order_;
  std::unique_ptr<DecodePool> pool_;
};

TEST_F(DecodePoolTest, WhatIsNeededNowComesFirst) {
  make_pool(1);
  submit(1, DecodeGroup::kNeeded);
  wait_until_taken(0);
  submit(2, DecodeGroup::kPrefetch);
  submit(3, DecodeGroup::kRefinement);
  submit(4, DecodeGroup::kNeeded);
  submit(5, DecodeGroup::kNeeded);
  submit(6, DecodeGroup::kFallback);
  let_go();
  EXPECT_EQ(wait_for(6), (std::vector<ContentHash>{1, 6, 4, 5, 3, 2}));
}

TEST_F(DecodePoolTest, RegroupFollowsTheViewer) {
  make_pool(1);
  submit(1, DecodeGroup::kNeeded);
  wait_until_taken(0);
  submit(2, DecodeGroup::kNeeded);
  submit(3, DecodeGroup::kPrefetch);
  pool_->regroup([](const PayloadName& name) { return name.key == 3 ? DecodeGroup::kNeeded : DecodeGroup::kPrefetch; });
  let_go();
  EXPECT_EQ(wait_for(3), (std::vector<ContentHash>{1, 3, 2}));
}

TEST_F(DecodePoolTest, CountsWaitingBytesForBackPressure) {
  make_pool(1);
  submit(1, DecodeGroup::kNeeded, 10);
  wait_until_taken(0);
  submit(2, DecodeGroup::kNeeded, 100);
  submit(3, DecodeGroup::kPrefetch, 1000);
  EXPECT_EQ(pool_->queued_bytes(), 1100u);
  let_go();
  wait_for(3);
  EXPECT_EQ(pool_->queued_bytes(), 0u);
}

TEST_F(DecodePoolTest, DestructionDiscardsWhatWaits) {
  make_pool(1);
  submit(1, DecodeGroup::kNeeded);
  wait_until_taken(0);
  for (ContentHash key = 2; key < 100; ++key) submit(key, DecodeGroup::kPrefetch);
  std::thread opener([this] {
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    let_go();
  });
  pool_ = nullptr;
  opener.join();
  EXPECT_EQ(order_, std::vector<ContentHash>{1});
}

TEST(DecodePool, ALibraryThatThrowsIsAnErrorNotACrash) {
  PayloadDecoder decoder(CellGrid{0.5}, DecodeForm::kMesh,
                         [](ByteView) -> Result<Tile> { throw std::bad_alloc(); });
  std::promise<ErrorCode> code;
  DecodePool pool(std::move(decoder), 2, [&](const PayloadName&, Result<DecodedPayload> result) {
    code.set_value(result ? ErrorCode::kCancelled : result.error().code);
  });
  pool.submit({{PayloadKind::kTile, 1, 0, 0}, std::make_shared<const Bytes>(4)}, DecodeGroup::kNeeded);
  EXPECT_EQ(code.get_future().get(), ErrorCode::kInternal);
}

}  // namespace
}  // namespace farfield::client
