// SPDX-License-Identifier: Apache-2.0
// The streaming part of a session over real loopback: what is sent, in which order, and what is not sent again.
#include <gtest/gtest.h>

#include <algorithm>
#include <mutex>

#include "server/session/payload_order.h"
#include "server/session/server.h"
#include "tests/unit/server/session/fake_cell_service.h"
#include "tests/unit/server/session/test_client.h"

namespace farfield {
namespace {

using namespace std::chrono_literals;
using test::FakeCellService;
using test::FakeWorld;
using test::TestClient;

constexpr glm::dvec3 kHere{1, 1, 1};
constexpr glm::dvec3 kThere{21, 1, 1};
// Two shared and four own tiles, two chunks, eight texture levels.
constexpr std::size_t kPayloads = 16;
constexpr std::size_t kOwnTiles = 4;

class SessionTest : public ::testing::Test {
 protected:
  void serve(const FakeWorld& world = {}, ServerLimits limits = {}, std::function<void(const std::string&)> log = {}) {
    service = std::make_shared<FakeCellService>(world);
    ServerOptions options;
    options.log = std::move(log);
    options.listen = {"127.0.0.1", 0};
    options.threads = 2;
    options.limits = limits;
    auto started = Server::start(options, {service});
    ASSERT_TRUE(started) << started.error().message;
    server = std::move(*started);
  }

  std::shared_ptr<FakeCellService> service;
  std::unique_ptr<Server> server;
};

TEST_F(SessionTest, APoseBringsTheLeafSetThenItsPayloadsThenItsEnd) {
  serve();
  TestClient client(server->endpoint());
  ASSERT_TRUE(client.enter());
  EXPECT_EQ(client.welcome->version(), 1u);
  EXPECT_EQ(client.welcome->scene().name(), "fake");
  EXPECT_EQ(client.welcome->scene().triangles(), 12345u);
  EXPECT_GT(client.welcome->limits().poses_per_second(), 0u);
  client.move_to(kHere);
  ASSERT_TRUE(client.wait_complete(1));
  ASSERT_EQ(client.sets.size(), 1u);
  const wire::LeafSet& set = client.sets[0];
  EXPECT_TRUE(set.is_current());
  EXPECT_EQ(set.tiles_size(), 6);
  ASSERT_EQ(set.chunks_size(), 2);
  EXPECT_EQ(set.chunks(0).transform_size(), 3);
  EXPECT_EQ(set.chunks(1).transform_size(), 12);
  EXPECT_FLOAT_EQ(set.chunks(0).transform(0), 2) << "3 m in the scene, from the leaf's centre at 1 m";
  EXPECT_EQ(client.payloads(), kPayloads);
  EXPECT_EQ(client.complete[0], set.serial());
  for (const ContentHash key : set.tiles()) EXPECT_EQ(client.received[key], 1);
  EXPECT_EQ(client.empty_tiles.size(), 1u) << "a tile that turned out empty is told, not withheld";
}

TEST_F(SessionTest, AClientThatComplainsAgainAndAgainIsLoggedOnce) {
  struct Log {
    std::mutex mutex;
    std::vector<std::string> lines;
  };
  const auto log = std::make_shared<Log>();  // the server, which is the fixture's, logs on after the test's body
  serve({}, {}, [log](const std::string& line) {
    const std::lock_guard lock(log->mutex);
    log->lines.push_back(line);
  });
  TestClient client(server->endpoint());
  ASSERT_TRUE(client.enter());
  wire::Failure failure;
  failure.set_message("two\nlines");
  for (int i = 0; i < 50; ++i) client.send(MessageType::kFailure, failure);
  client.move_to(kHere);  // answered after all of them were read
  ASSERT_TRUE(client.wait_complete(1));
  const std::lock_guard lock(log->mutex);
  EXPECT_EQ(std::count_if(log->lines.begin(), log->lines.end(), [](const std::string& l) { return l.find("reports: two?lines") != std::string::npos; }), 1);
}

TEST_F(SessionTest, GeometryWithCoarseTexturesComesFirstAndFineLevelsLast) {
  serve();
  TestClient client(server->endpoint());
  ASSERT_TRUE(client.enter());
  client.move_to(kHere);
  ASSERT_TRUE(client.wait_complete(1));
  std::string kinds;
  for (const auto& [type, key] : client.order) kinds += type == 48 ? 't' : type == 49 ? 'c' : 'm';
  EXPECT_EQ(kinds, "cmmmmmmmcttttttm");
}

TEST_F(SessionTest, StandingStillSendsNothing) {
  serve();
  TestClient client(server->endpoint());
  ASSERT_TRUE(client.enter());
  for (int i = 0; i < 5; ++i) client.move_to(kHere, i * 0.1);
  ASSERT_TRUE(client.wait_complete(1));
  const std::uint64_t frames = client.frames, bytes = client.connection->counters().bytes_in;
  for (int i = 5; i < 20; ++i) client.move_to(kHere + glm::dvec3(0.01 * (i % 3), 0, 0), i * 0.1);
  client.idle(100ms);
  EXPECT_EQ(client.frames, frames);
  EXPECT_EQ(client.connection->counters().bytes_in, bytes);
  EXPECT_EQ(service->leaf_requests(), 1) << "the leaf answers for every viewpoint in it";
}

TEST_F(SessionTest, NothingIsSentTwice) {
  serve();
  TestClient client(server->endpoint());
  ASSERT_TRUE(client.enter());
  client.move_to(kHere);
  ASSERT_TRUE(client.wait_complete(1));
  client.move_to(kThere, 10);
  ASSERT_TRUE(client.wait_complete(2));
  EXPECT_EQ(client.payloads(), kPayloads + kOwnTiles);
  EXPECT_EQ(client.repeated(), 0u);
  // Back again: the manifest and everything in it is known.
  const std::uint64_t frames = client.frames;
  client.move_to(kHere, 20);
  client.idle(50ms);
  EXPECT_EQ(client.frames, frames);
  EXPECT_EQ(server->metrics().leaf_sets_reused, 1u);
  // Of the second set it held two far tiles, two chunks and eight texture levels.
  EXPECT_EQ(server->metrics().payloads_held, 12u);
  EXPECT_EQ(server->metrics().tiles_held, 2u);
  EXPECT_EQ(server->metrics().payload_bytes_held, 2 * 1000u + 2 * 300u + 8 * 100u);
}

TEST_F(SessionTest, WhatWasEvictedIsSentAgainButNotForEver) {
  serve();
  TestClient client(server->endpoint());
  ASSERT_TRUE(client.enter());
  client.move_to(kHere);
  ASSERT_TRUE(client.wait_complete(1));
  wire::Evicted evicted;
  evicted.add_payloads(client.sets[0].tiles(0));
  evicted.add_payloads(123456789);  // never held
  client.send(MessageType::kEvicted, evicted);
  ASSERT_TRUE(client.wait_complete(2));
  EXPECT_EQ(client.received[client.sets[0].tiles(0)], 2);
  EXPECT_EQ(client.payloads(), kPayloads + 1);
  client.send(MessageType::kEvicted, evicted);
  ASSERT_TRUE(client.wait_complete(3));
  EXPECT_EQ(client.received[client.sets[0].tiles(0)], 2) << "who evicts it twice has no room for it";
}

TEST_F(SessionTest, AHelloThatListsPayloadsIsBelieved) {
  serve();
  std::vector<ContentHash> held;
  {
    TestClient client(server->endpoint());
    ASSERT_TRUE(client.enter());
    client.move_to(kHere);
    ASSERT_TRUE(client.wait_complete(1));
    held = client.held();
  }
  TestClient client(server->endpoint());
  wire::Hello hello = TestClient::hello();
  for (const ContentHash key : held) hello.add_held(key);
  ASSERT_TRUE(client.enter(hello));
  client.move_to(kHere);
  ASSERT_TRUE(client.wait_complete(1));
  EXPECT_EQ(client.payloads(), 0u);
  EXPECT_EQ(client.sets.size(), 1u);
}

TEST_F(SessionTest, ASessionResumesAfterACut) {
  serve();
  std::string token;
  std::vector<ContentHash> held;
  std::uint64_t serial = 0;
  {
    TestClient client(server->endpoint());
    ASSERT_TRUE(client.enter());
    client.move_to(kHere);
    ASSERT_TRUE(client.wait_complete(1));
    token = client.welcome->resume_token();
    held = client.held();
    serial = client.sets[0].serial();
  }
  held.pop_back();  // one payload was under way when the connection broke
  TestClient client(server->endpoint());
  wire::Hello hello = TestClient::hello();
  hello.set_resume_token(token);
  for (const ContentHash key : held) hello.add_held(key);
  ASSERT_TRUE(client.enter(hello));
  EXPECT_TRUE(client.welcome->resumed());
  EXPECT_NE(client.welcome->resume_token(), token) << "a token is spent once";
  ASSERT_TRUE(client.wait_complete(1)) << "the last leaf is known before the first pose";
  EXPECT_GT(client.sets[0].serial(), serial);
  EXPECT_EQ(client.payloads(), 1u) << "only what was lost";
}

TEST_F(SessionTest, ATokenWorksWhileTheServerStillBelievesInTheOldConnection) {
  serve();
  TestClient old(server->endpoint());
  ASSERT_TRUE(old.enter());
  TestClient client(server->endpoint());
  wire::Hello hello = TestClient::hello();
  hello.set_resume_token(old.welcome->resume_token());
  ASSERT_TRUE(client.enter(hello));
  EXPECT_TRUE(client.welcome->resumed());
  EXPECT_TRUE(old.wait([&] { return old.closed.has_value(); }));
}

TEST_F(SessionTest, UnknownTokensBeginANewSession) {
  serve();
  TestClient client(server->endpoint());
  wire::Hello hello = TestClient::hello();
  hello.set_resume_token("0123456789abcdef");
  ASSERT_TRUE(client.enter(hello));
  EXPECT_FALSE(client.welcome->resumed());
}

TEST_F(SessionTest, LeavingALeafWithdrawsWhatIsStale) {
  serve();
  service->hold_tiles();
  TestClient client(server->endpoint());
  ASSERT_TRUE(client.enter());
  client.move_to(kHere);
  ASSERT_TRUE(client.wait([&] { return service->held_tiles() == 6; }));
  client.move_to(kThere, 10);
  ASSERT_TRUE(client.wait([&] { return service->tile_requests() == 6 + static_cast<int>(kOwnTiles); }));
  EXPECT_TRUE(client.wait([&] { return service->withdrawn() >= static_cast<int>(kOwnTiles); }));
  service->release_tiles();
  ASSERT_TRUE(client.wait_complete(1));
  ASSERT_EQ(client.sets.size(), 2u);
  EXPECT_EQ(client.complete[0], client.sets[1].serial()) << "the leaf that was left is never completed";
  for (int i = 2; i < 6; ++i) EXPECT_EQ(client.received.count(client.sets[0].tiles(i)), 0u) << "stale tile " << i;
  EXPECT_EQ(client.repeated(), 0u);
  EXPECT_GE(server->metrics().payloads_stale, kOwnTiles);
}

TEST_F(SessionTest, ALeafLeftWhenNearlyCompleteIsFinishedBeforeTheNext) {
  FakeWorld world;
  world.tiles = 24;
  ServerLimits limits;
  limits.requests = 4;
  serve(world, limits);
  TestClient client(server->endpoint());
  ASSERT_TRUE(client.enter());
  client.move_to(kHere);
  ASSERT_TRUE(client.wait_complete(1));
  // Two tiles of it are lost, and cannot be made before the viewer is next door.
  service->hold_tiles();
  wire::Evicted evicted;
  for (int i = 10; i < 12; ++i) evicted.add_payloads(client.sets[0].tiles(i));
  client.send(MessageType::kEvicted, evicted);
  ASSERT_TRUE(client.wait([&] { return service->held_tiles() == 2; }));
  client.move_to(kHere + glm::dvec3(2, 0, 0), 10);
  ASSERT_TRUE(client.wait([&] { return client.sets.size() == 2; }));
  EXPECT_EQ(service->withdrawn(), 0) << "two tiles against all of the next leaf";
  service->release_tiles();
  ASSERT_TRUE(client.wait_complete(3));
  EXPECT_EQ(client.complete[1], client.sets[0].serial());
  EXPECT_EQ(client.complete[2], client.sets[1].serial());
}

TEST_F(SessionTest, WhoWalksFasterThanPlansAreMadeStillGetsPlans) {
  serve();
  TestClient client(server->endpoint());
  ASSERT_TRUE(client.enter());
  service->hold_leaves();
  for (int i = 0; i < 12; ++i) {
    client.move_to({1 + 2 * i, 1, 1}, i * 0.5);
    client.idle(40ms);
  }
  EXPECT_EQ(service->held_leaves(), 1u) << "plans made on the way would only delay this one";
  ASSERT_TRUE(service->answer_leaf());
  ASSERT_TRUE(client.wait([&] { return client.sets.size() == 1; }));
  EXPECT_EQ(client.sets[0].leaf().x(), service->grid().cell_at(kHere, 0).x) << "the first question is never given up";
  while (service->answer_leaf()) {
  }
  const CellId last = service->grid().cell_at({23, 1, 1}, 0);
  const auto is_last = [&](const wire::LeafSet& set) { return set.is_current() && set.leaf().x() == last.x; };
  EXPECT_TRUE(client.wait([&] { return std::any_of(client.sets.begin(), client.sets.end(), is_last); }));
}

TEST_F(SessionTest, WhoJumpsIsPlannedForBesideWhatIsUnderWay) {
  serve();
  TestClient client(server->endpoint());
  ASSERT_TRUE(client.enter());
  service->hold_leaves();
  for (int i = 0; i < 4; ++i) {
    client.move_to({1 + 200 * i, 1, 1}, i * 0.5);
    client.idle(40ms);
  }
  EXPECT_EQ(service->held_leaves(), 2u) << "the first, and the newest";
  while (service->answer_leaf()) {
  }
  const CellId last = service->grid().cell_at({601, 1, 1}, 0);
  EXPECT_TRUE(client.wait([&] { return !client.sets.empty() && client.sets.back().leaf().x() == last.x; }));
}

TEST_F(SessionTest, BehindAWallOfTheSameLeafAnotherSetHolds) {
  FakeWorld world;
  world.has_walls = true;
  serve(world);
  TestClient client(server->endpoint());
  ASSERT_TRUE(client.enter());
  client.move_to({0.5, 1, 1});
  ASSERT_TRUE(client.wait_complete(1));
  client.move_to({1.5, 1, 1}, 10);
  ASSERT_TRUE(client.wait_complete(2));
  ASSERT_EQ(client.sets.size(), 2u);
  EXPECT_EQ(client.sets[0].leaf().x(), client.sets[1].leaf().x());
  EXPECT_EQ(client.sets[0].tiles_size(), 6);
  EXPECT_EQ(client.sets[1].tiles_size(), 2);
  EXPECT_NE(client.sets[0].enclosure(), client.sets[1].enclosure());
  EXPECT_EQ(client.repeated(), 0u);
  client.move_to({0.5, 1, 1}, 20);
  EXPECT_TRUE(client.wait([&] { return server->metrics().leaf_sets_reused >= 1; })) << "both are known now";
  EXPECT_EQ(client.sets.size(), 2u);
}

TEST_F(SessionTest, NothingIsPrefetchedWhileTheCurrentLeafIsIncomplete) {
  serve();
  service->hold_tiles();
  TestClient client(server->endpoint());
  ASSERT_TRUE(client.enter());
  for (int i = 0; i < 20; ++i) client.move_to({0.1 + 0.05 * i, 1, 1}, i / 30.0);
  ASSERT_TRUE(client.wait([&] { return service->held_tiles() == 6; }));
  client.idle(50ms);
  EXPECT_EQ(service->prefetch_requests(), 0);
  EXPECT_EQ(client.sets.size(), 1u);
  service->release_tiles();
  ASSERT_TRUE(client.wait([&] { return client.sets.size() >= 2; })) << "spare capacity is used without another pose";
}

TEST_F(SessionTest, TheFallbackViewGoesFirstWhenAskedFor) {
  serve();
  TestClient client(server->endpoint());
  ASSERT_TRUE(client.enter());
  client.move_to(kHere, 0, true);
  ASSERT_TRUE(client.wait_complete(2));
  ASSERT_EQ(client.sets.size(), 2u);
  const auto is_fallback = [](const wire::LeafSet& set) { return set.is_fallback(); };
  const auto fallback = std::find_if(client.sets.begin(), client.sets.end(), is_fallback);
  ASSERT_NE(fallback, client.sets.end());
  EXPECT_EQ(client.complete[0], fallback->serial());
  EXPECT_EQ(fallback->tiles_size(), 1);
  EXPECT_EQ(client.repeated(), 0u) << "chunks of both sets go once";
}

TEST_F(SessionTest, TheFallbackViewNeedsNoLeaf) {
  serve();
  service->hold_leaves();
  TestClient client(server->endpoint());
  ASSERT_TRUE(client.enter());
  client.move_to(kHere, 0, true);
  ASSERT_TRUE(client.wait_complete(1));
  ASSERT_EQ(client.sets.size(), 1u);
  EXPECT_TRUE(client.sets[0].is_fallback());
  // Asked for again inside its cell it is not sent again; outside another is.
  client.move_to(kHere + glm::dvec3(0.1, 0, 0), 0.1, true);
  client.move_to(kHere + glm::dvec3(50, 0, 0), 0.2, true);
  ASSERT_TRUE(client.wait_complete(2));
  EXPECT_EQ(client.sets.size(), 2u);
  EXPECT_NE(client.sets[1].leaf().x(), client.sets[0].leaf().x());
}

TEST_F(SessionTest, NothingIsPrefetchedForAClientThatStillDecodesItsLeafSet) {
  serve();
  TestClient client(server->endpoint());
  ASSERT_TRUE(client.enter());
  client.awaits_leaf_set = true;
  for (int i = 0; i < 20; ++i) client.move_to({0.1 + 0.05 * i, 1, 1}, i / 30.0);
  ASSERT_TRUE(client.wait_complete(1));
  client.idle(50ms);
  EXPECT_EQ(service->prefetch_requests(), 0);
  client.awaits_leaf_set = false;
  client.move_to({1.1, 1, 1}, 20 / 30.0);
  ASSERT_TRUE(client.wait([&] { return client.sets.size() >= 2; }));
  EXPECT_FALSE(client.sets[1].is_current());
}

TEST_F(SessionTest, WalkingOnPrefetchesTheLeavesAhead) {
  serve();
  TestClient client(server->endpoint());
  ASSERT_TRUE(client.enter());
  for (int i = 0; i < 20; ++i) client.move_to({0.1 + 0.05 * i, 1, 1}, i / 30.0);  // 1.5 m/s towards +x
  ASSERT_TRUE(client.wait([&] { return client.sets.size() >= 2 && client.complete.size() == client.sets.size(); }));
  EXPECT_TRUE(client.sets[0].is_current());
  EXPECT_FALSE(client.sets[1].is_current());
  EXPECT_EQ(client.sets[1].leaf().x(), client.sets[0].leaf().x() + 1);
  EXPECT_GT(service->prefetch_requests(), 0);
  // Entering it costs nothing any more.
  const std::size_t payloads = client.payloads();
  client.move_to({2.05, 1, 1}, 20 / 30.0);
  client.idle(50ms);
  EXPECT_EQ(client.repeated(), 0u);
  const auto own = client.sets[1].tiles(3);
  EXPECT_EQ(client.received[own], 1);
  EXPECT_GE(client.payloads(), payloads);
}

TEST_F(SessionTest, LeavesAheadInWhichNobodyCanStandAreAskedAboutOnceAndCounted) {
  FakeWorld world;
  world.is_blocked_ahead = true;
  serve(world);
  TestClient client(server->endpoint());
  ASSERT_TRUE(client.enter());
  for (int i = 0; i < 20; ++i) client.move_to({0.1 + 0.05 * i, 1, 1}, i / 30.0);  // 1.5 m/s towards +x
  ASSERT_TRUE(client.wait([&] { return server->metrics().leaves_blocked_ahead > 0; }));
  client.idle(50ms);
  EXPECT_EQ(client.sets.size(), 1u) << "none is sent ahead";
  // Six metres ahead are three or four leaves: each was asked about once, not with every pose.
  EXPECT_LE(service->prefetch_requests(), 5);
  EXPECT_EQ(server->metrics().leaves_blocked_ahead, static_cast<std::uint64_t>(service->prefetch_requests()));
  // Who comes there after all is served.
  client.move_to({2.05, 1, 1}, 20 / 30.0);
  ASSERT_TRUE(client.wait([&] { return client.sets.size() == 2; }));
}

TEST_F(SessionTest, WhatCouldNotBeMadeIsAskedForAgain) {
  ServerLimits limits;
  limits.ping_after = 200ms;  // the watch runs at a quarter of this
  serve({}, limits);
  service->fail_tiles(3);
  TestClient client(server->endpoint());
  ASSERT_TRUE(client.enter());
  client.move_to(kHere);
  ASSERT_TRUE(client.wait_complete(1));
  EXPECT_EQ(client.payloads(), kPayloads);
  EXPECT_EQ(server->metrics().payloads_failed, 3u);
}

TEST_F(SessionTest, ASlowReaderCostsBoundedMemoryAndDelaysNobody) {
  FakeWorld world;
  world.tiles = 200;
  world.tile_bytes = 200'000;
  ServerLimits limits;
  limits.outbox_bytes = 500'000;
  limits.requests = 8;
  serve(world, limits);
  // Says hello and where it is, then never reads.
  asio::io_context context;
  asio::ip::tcp::socket deaf(context);
  deaf.open(asio::ip::tcp::v4());
  deaf.set_option(asio::socket_base::receive_buffer_size(4096));
  deaf.connect({asio::ip::make_address("127.0.0.1"), server->endpoint().port});
  TestClient quick(server->endpoint());
  const OutgoingFrame hello = make_message(MessageType::kHello, TestClient::hello());
  deaf.send(asio::buffer(hello.head));
  wire::Pose pose;
  const CellId cell = service->grid().cell_at(kThere, 0);
  pose.mutable_cell()->set_x(cell.x);
  pose.mutable_cell()->set_y(cell.y);
  pose.mutable_cell()->set_z(cell.z);
  pose.set_qw(1);
  deaf.send(asio::buffer(make_message(MessageType::kPose, pose).head));
  ASSERT_TRUE(quick.wait([&] { return service->tile_requests() > 0; }));
  quick.idle(100ms);
  const int asked = service->tile_requests();
  // What one socket's buffers take, the outbox, and the requests allowed: far less than the 200 tiles of the set.
  EXPECT_LT(asked, 60);
  ASSERT_TRUE(quick.enter());
  quick.move_to(kHere);
  ASSERT_TRUE(quick.wait_complete(1));
  EXPECT_EQ(quick.repeated(), 0u);
}

TEST_F(SessionTest, PosesBeyondTheRateAreDroppedButNeverTheLast) {
  ServerLimits limits;
  limits.poses_per_second = 20;
  serve({}, limits);
  TestClient client(server->endpoint());
  ASSERT_TRUE(client.enter());
  for (int i = 0; i < 200; ++i) client.move_to({1 + 0.001 * i, 1, 1}, i * 0.001);
  client.move_to(kThere, 1);
  const CellId there = service->grid().cell_at(kThere, 0);
  const auto is_there = [&](const wire::LeafSet& set) { return set.is_current() && set.leaf().x() == there.x; };
  EXPECT_TRUE(client.wait([&] { return std::any_of(client.sets.begin(), client.sets.end(), is_there); }));
  EXPECT_GT(server->metrics().poses_dropped, 100u);
}

}  // namespace
}  // namespace farfield
