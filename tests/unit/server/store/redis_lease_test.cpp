// SPDX-License-Identifier: Apache-2.0
// Turns between servers through a real Redis server.
#include "server/store/redis_lease.h"

#include <gtest/gtest.h>

#include "tests/support/redis_server.h"

namespace farfield {
namespace {

using namespace std::chrono_literals;

BlobKey key_of(int k) { return {.world = 1, .name = {.cell = {.level = 1, .x = k}}}; }
SharedBytes blob_of(int k) { return std::make_shared<const Bytes>(Bytes(100, static_cast<std::uint8_t>(k))); }
bool eventually(const std::function<bool()>& holds) {
  for (int i = 0; i < 10000 && !holds(); ++i) std::this_thread::sleep_for(1ms);
  return holds();
}

// What one server has of Redis.
struct Peer {
  explicit Peer(const TestRedis& redis, std::chrono::milliseconds duration = RedisLease::kDuration)
      : client(std::make_shared<RedisClient>(RedisClientOptions{.address = redis.address(), .longest_pause = 200ms})),
        store(std::make_shared<RedisStore>(client, RedisStoreOptions{})),
        lease(std::make_unique<RedisLease>(client, store, duration)) {}
  bool holds(int k) {
    const BlobKey key = key_of(k);
    return lease->are_held({&key, 1})[0];
  }
  std::shared_ptr<RedisClient> client;
  std::shared_ptr<RedisStore> store;
  std::unique_ptr<RedisLease> lease;
};

class RedisLeaseTest : public testing::Test {
 protected:
  void SetUp() override { ASSERT_TRUE(redis_.is_there()) << "redis-server (Debian's package) does not start"; }
  TestRedis redis_;
};

TEST_F(RedisLeaseTest, OneMakesItAndTheOtherFindsItMade) {
  Peer first(redis_), second(redis_);
  EXPECT_FALSE(second.holds(1));
  EXPECT_EQ(first.lease->acquire(key_of(1)), Turn::kOurs);
  EXPECT_EQ(second.lease->acquire(key_of(1)), Turn::kTheirs);
  EXPECT_EQ(second.lease->acquire(key_of(2)), Turn::kOurs) << "another";
  EXPECT_TRUE(second.holds(1));
  first.store->insert(key_of(1), blob_of(1));
  first.lease->release(key_of(1));
  ASSERT_TRUE(eventually([&] { return !second.holds(1); }));
  EXPECT_TRUE(second.store->find(key_of(1))) << "the lease goes after the value has come";
  EXPECT_EQ(second.lease->acquire(key_of(1)), Turn::kMade);
  EXPECT_FALSE(second.holds(1)) << "and nobody need release what was made";
}

TEST_F(RedisLeaseTest, ATurnGivenUpIsTheNextOnes) {
  Peer first(redis_), second(redis_);
  ASSERT_EQ(first.lease->acquire(key_of(1)), Turn::kOurs);
  first.lease->release(key_of(1));
  ASSERT_TRUE(eventually([&] { return !second.holds(1); }));
  EXPECT_EQ(second.lease->acquire(key_of(1)), Turn::kOurs);
  first.lease->release(key_of(1));  // once more: it holds none
  ASSERT_TRUE(first.store->flush());
  EXPECT_TRUE(second.holds(1));
}

TEST_F(RedisLeaseTest, ItIsRenewedWhileItsHolderLivesAndEndsAfterItDied) {
  constexpr auto kDuration = 300ms;
  auto first = std::make_unique<Peer>(redis_, kDuration);
  Peer second(redis_);
  ASSERT_EQ(first->lease->acquire(key_of(1)), Turn::kOurs);
  // Long beyond its end, were it not renewed; on a machine so busy that renewing comes late there is nothing to be seen.
  for (int k = 0; k < 20; ++k) {
    std::this_thread::sleep_for(50ms);
    if (redis_.ask({"PTTL", redis_key(key_of(1), 'l')}).integer < 0) GTEST_SKIP() << "the renewing thread was not run for 200 ms";
  }
  EXPECT_EQ(second.lease->acquire(key_of(1)), Turn::kTheirs);
  first.reset();  // without releasing
  ASSERT_TRUE(eventually([&] { return !second.holds(1); }));
  EXPECT_EQ(second.lease->acquire(key_of(1)), Turn::kOurs);
}

TEST_F(RedisLeaseTest, OnlyItsHolderReleasesIt) {
  Peer first(redis_), second(redis_);
  ASSERT_EQ(first.lease->acquire(key_of(1)), Turn::kOurs);
  redis_.ask({"DEL", redis_key(key_of(1), 'l')});  // as if it had expired while the first was suspended
  ASSERT_EQ(second.lease->acquire(key_of(1)), Turn::kOurs);
  first.lease->release(key_of(1));
  ASSERT_TRUE(first.store->flush());
  EXPECT_TRUE(first.holds(1));
}

TEST_F(RedisLeaseTest, WithoutRedisEveryoneIsAlone) {
  Peer first(redis_);
  redis_.kill_now();
  EXPECT_EQ(first.lease->acquire(key_of(1)), Turn::kAlone);
  EXPECT_FALSE(first.holds(1));
  first.lease->release(key_of(1));
  redis_.start();
  ASSERT_TRUE(eventually([&] { return first.client->is_there(); }));
  EXPECT_EQ(first.lease->acquire(key_of(1)), Turn::kOurs);
}

}  // namespace
}  // namespace farfield
