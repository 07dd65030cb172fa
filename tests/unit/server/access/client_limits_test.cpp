// SPDX-License-Identifier: Apache-2.0
// Rates with a clock of the test's own.
#include "server/access/client_limits.h"

#include <gtest/gtest.h>

#include <vector>

namespace farfield {
namespace {

using namespace std::chrono_literals;

ClientKey key(const char* address) { return key_of(asio::ip::make_address(address)); }

class ClientLimitsTest : public ::testing::Test {
 protected:
  ClientLimits::Clock::time_point now{1h};
  ClientPolicy policy{.connections = 3, .connects_per_second = 2, .connect_burst = 5, .views_per_second = 10, .failures_per_second = 0.1, .failure_burst = 2, .remembered = 4};
};

TEST_F(ClientLimitsTest, ConnectionsAreCountedWhileTheyLive) {
  const auto limits = ClientLimits::create(policy, "address");
  std::vector<std::shared_ptr<ClientLimits::Visit>> visits;
  for (int i = 0; i < 3; ++i) visits.push_back(*limits->enter(key("10.0.0.1"), now));
  const auto refused = limits->enter(key("10.0.0.1"), now);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().reason, "this address has 3 connections already");
  EXPECT_GT(refused.error().retry_after, 0ms);
  EXPECT_TRUE(limits->enter(key("10.0.0.2"), now));  // nobody else is kept out
  visits.pop_back();
  EXPECT_TRUE(limits->enter(key("10.0.0.1"), now));
}

TEST_F(ClientLimitsTest, ConnectsHaveARateAndSayWhenToComeBack) {
  const auto limits = ClientLimits::create(policy, "address");
  for (int i = 0; i < 5; ++i) EXPECT_TRUE(limits->enter(key("10.0.0.1"), now)) << i;
  const auto refused = limits->enter(key("10.0.0.1"), now);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().reason, "this address connects too often");
  EXPECT_LE(refused.error().retry_after, 501ms);
  now += refused.error().retry_after;
  EXPECT_TRUE(limits->enter(key("10.0.0.1"), now));
  EXPECT_FALSE(limits->enter(key("10.0.0.1"), now));
}

TEST_F(ClientLimitsTest, FailedAttemptsCloseTheDoorForAWhile) {
  const auto limits = ClientLimits::create(policy, "address");
  const auto visit = *limits->enter(key("10.0.0.1"), now);
  visit->note_failure(now);
  EXPECT_TRUE(limits->enter(key("10.0.0.1"), now));
  visit->note_failure(now);
  const auto refused = limits->enter(key("10.0.0.1"), now);
  ASSERT_FALSE(refused);
  EXPECT_LE(refused.error().retry_after, 10'001ms);
  EXPECT_GT(refused.error().retry_after, 9s);
  now += 10s;
  EXPECT_TRUE(limits->enter(key("10.0.0.1"), now));
}

TEST_F(ClientLimitsTest, ViewsAreSharedByAllConnections) {
  const auto limits = ClientLimits::create(policy, "token");
  const auto first = *limits->enter(key("10.0.0.1"), now), second = *limits->enter(key("10.0.0.1"), now);
  for (int i = 0; i < 20; ++i) EXPECT_EQ((i % 2 ? first : second)->view(now), 0s) << i;
  const auto wait = first->view(now);
  EXPECT_GT(wait, 0s);
  EXPECT_LE(wait, 101ms);
  now += wait;
  EXPECT_EQ(second->view(now), 0s);
}

TEST_F(ClientLimitsTest, AnAddressOfSixIsItsNetworkAndAMappedOneItself) {
  EXPECT_EQ(key("2001:db8:1:2::1"), key("2001:db8:1:2:ffff::9"));
  EXPECT_NE(key("2001:db8:1:2::1"), key("2001:db8:1:3::1"));
  EXPECT_EQ(key("::ffff:10.0.0.1"), key("10.0.0.1"));
  EXPECT_NE(key("10.0.0.1"), key("10.0.0.2"));
}

TEST_F(ClientLimitsTest, RemembersNoMoreThanItMay) {
  const auto limits = ClientLimits::create(policy, "address");
  const auto staying = *limits->enter(key("10.0.0.1"), now);
  for (int i = 2; i < 200; ++i) {
    EXPECT_TRUE(limits->enter(key(("10.0.0." + std::to_string(i)).c_str()), now));
    EXPECT_LE(limits->remembered(), 4u);
  }
  // Whoever is connected is not forgotten.
  std::vector<std::shared_ptr<ClientLimits::Visit>> visits{*limits->enter(key("10.0.0.1"), now), *limits->enter(key("10.0.0.1"), now)};
  EXPECT_FALSE(limits->enter(key("10.0.0.1"), now));
}

}  // namespace
}  // namespace farfield
