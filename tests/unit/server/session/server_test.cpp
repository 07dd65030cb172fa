// SPDX-License-Identifier: Apache-2.0
// Hello, refusals, hostile peers, draining: everything around the streaming.
#include "server/session/server.h"

#include <gtest/gtest.h>

#include <asio/read.hpp>
#include <asio/write.hpp>

#include "tests/unit/server/session/fake_cell_service.h"
#include "tests/unit/server/session/test_client.h"

namespace farfield {
namespace {

using namespace std::chrono_literals;
using test::FakeCellService;
using test::FakeWorld;
using test::TestClient;

class ServerTest : public ::testing::Test {
 protected:
  void serve(ServerLimits limits = {}) {
    FakeWorld first, second;
    first.name = "first";
    second.name = "second";
    ServerOptions options;
    options.listen = {"127.0.0.1", 0};
    options.threads = 2;
    options.limits = limits;
    auto started = Server::start(options, {std::make_shared<FakeCellService>(first), std::make_shared<FakeCellService>(second)});
    ASSERT_TRUE(started) << started.error().message;
    server = std::move(*started);
  }
  /// Sends raw bytes and waits until the server has closed. Returns: its last words.
  std::optional<wire::Failure> send_raw(const Bytes& bytes) {
    TestClient client(server->endpoint());
    OutgoingFrame raw;
    raw.head = bytes;
    client.connection->send(std::move(raw));
    EXPECT_TRUE(client.wait([&] { return client.closed.has_value(); }));
    return client.failure;
  }
  void expect_still_serving() {
    TestClient client(server->endpoint());
    ASSERT_TRUE(client.enter());
    client.move_to({1, 1, 1});
    EXPECT_TRUE(client.wait_complete(1));
  }

  std::unique_ptr<Server> server;
};

TEST_F(ServerTest, ServesTwoScenesByName) {
  serve();
  for (const auto& [asked, given] : {std::pair{"", "first"}, {"first", "first"}, {"second", "second"}}) {
    TestClient client(server->endpoint());
    ASSERT_TRUE(client.enter(TestClient::hello(asked)));
    EXPECT_EQ(client.welcome->scene().name(), given);
    ASSERT_EQ(client.welcome->catalogue_size(), 2);
    EXPECT_EQ(client.welcome->catalogue(1).name(), "second");
  }
}

TEST_F(ServerTest, AnUnknownSceneIsNamedWithTheOnesThereAre) {
  serve();
  TestClient client(server->endpoint());
  EXPECT_FALSE(client.enter(TestClient::hello("third\n")));
  ASSERT_TRUE(client.failure);
  EXPECT_TRUE(client.failure->fatal());
  EXPECT_EQ(client.failure->code(), static_cast<std::uint32_t>(ErrorCode::kNotFound));
  EXPECT_NE(client.failure->message().find("second"), std::string::npos);
  EXPECT_EQ(client.failure->message().find('\n'), std::string::npos);
}

TEST_F(ServerTest, VersionsWithoutOverlapAreRefusedAndNewerRangesThatOverlapAreNot) {
  serve();
  TestClient future(server->endpoint());
  wire::Hello hello = TestClient::hello();
  hello.set_version_min(2);
  hello.set_version_max(3);
  EXPECT_FALSE(future.enter(hello));
  ASSERT_TRUE(future.failure);
  EXPECT_EQ(future.failure->code(), static_cast<std::uint32_t>(ErrorCode::kVersionMismatch));
  TestClient both(server->endpoint());
  hello.set_version_min(1);
  ASSERT_TRUE(both.enter(hello));
  EXPECT_EQ(both.welcome->version(), 1u);
}

TEST_F(ServerTest, GarbageGetsAFailureAndHarmsNobody) {
  serve();
  const std::string http = "GET / HTTP/1.1\r\nHost: here\r\n\r\n";
  const auto failure = send_raw(Bytes(http.begin(), http.end()));
  ASSERT_TRUE(failure);
  EXPECT_EQ(failure->code(), static_cast<std::uint32_t>(ErrorCode::kBadData));
  expect_still_serving();
}

TEST_F(ServerTest, OversizedFramesAreRefusedUnread) {
  serve();
  ByteWriter head;
  head.put(kFrameMagic);
  head.put(kFrameVersion);
  head.put(static_cast<std::uint16_t>(MessageType::kHello));
  head.put(std::uint32_t{0xfffffff0});
  head.put(std::uint32_t{0});
  const auto failure = send_raw(head.take());
  ASSERT_TRUE(failure);
  EXPECT_EQ(failure->code(), static_cast<std::uint32_t>(ErrorCode::kLimitExceeded));
  expect_still_serving();
}

TEST_F(ServerTest, AFrameThatHoldsNoMessageIsRefused) {
  serve();
  const auto failure = send_raw(make_frame(MessageType::kHello, Bytes(40, 0xff)).head);
  ASSERT_TRUE(failure);
  EXPECT_EQ(failure->code(), static_cast<std::uint32_t>(ErrorCode::kBadData));
}

TEST_F(ServerTest, APoseBeforeHelloIsRefused) {
  serve();
  const auto failure = send_raw(make_message(MessageType::kPose, wire::Pose()).head);
  ASSERT_TRUE(failure);
  EXPECT_EQ(failure->code(), static_cast<std::uint32_t>(ErrorCode::kBadData));
}

TEST_F(ServerTest, APoseThatIsNoneIsRefused) {
  serve();
  std::vector<wire::Pose> poses(5);
  for (wire::Pose& pose : poses) pose.set_qw(1);
  poses[0].set_dx(std::numeric_limits<float>::quiet_NaN());
  poses[1].set_dy(1e30f);
  poses[2].mutable_cell()->set_level(60);
  poses[3].mutable_cell()->set_x(-1);
  poses[4].set_qw(0);
  for (const wire::Pose& pose : poses) {
    TestClient client(server->endpoint());
    ASSERT_TRUE(client.enter());
    client.send(MessageType::kPose, pose);
    EXPECT_TRUE(client.wait([&] { return client.closed.has_value(); })) << pose.ShortDebugString();
    EXPECT_TRUE(client.failure.has_value());
  }
}

TEST_F(ServerTest, MoreHeldHashesThanAnnouncedAreRefused) {
  ServerLimits limits;
  limits.held = 10;
  serve(limits);
  TestClient client(server->endpoint());
  wire::Hello hello = TestClient::hello();
  for (std::uint64_t i = 0; i < 11; ++i) hello.add_held(i);
  EXPECT_FALSE(client.enter(hello));
  ASSERT_TRUE(client.failure);
  EXPECT_EQ(client.failure->code(), static_cast<std::uint32_t>(ErrorCode::kLimitExceeded));
}

TEST_F(ServerTest, UnknownTypesAreSkippedAndCounted) {
  serve();
  TestClient client(server->endpoint());
  client.connection->send(make_frame(static_cast<MessageType>(999), Bytes(50), std::make_shared<Bytes>(1000)));
  ASSERT_TRUE(client.enter());
  client.connection->send(make_frame(static_cast<MessageType>(65535), {}));
  client.move_to({1, 1, 1});
  EXPECT_TRUE(client.wait_complete(1));
  EXPECT_EQ(server->metrics().unknown_frames, 2u);
}

TEST_F(ServerTest, HalfAFrameWaitsAndAVanishedPeerIsForgotten) {
  serve();
  {
    TestClient client(server->endpoint());
    OutgoingFrame half = make_message(MessageType::kHello, TestClient::hello());
    half.head.resize(half.head.size() / 2);
    client.connection->send(std::move(half));
    client.idle(30ms);
    EXPECT_FALSE(client.closed);
  }
  for (int i = 0; i < 200 && server->metrics().open_sessions > 0; ++i) std::this_thread::sleep_for(5ms);
  EXPECT_EQ(server->metrics().open_sessions, 0);
  expect_still_serving();
}

TEST_F(ServerTest, WhoSaysNothingIsShownOut) {
  ServerLimits limits;
  limits.hello_timeout = 50ms;
  limits.ping_after = 100ms;
  serve(limits);
  TestClient client(server->endpoint());
  EXPECT_TRUE(client.wait([&] { return client.closed.has_value(); }));
}

TEST_F(ServerTest, PingsAreAnswered) {
  serve();
  TestClient client(server->endpoint());
  ASSERT_TRUE(client.enter());
  client.send(MessageType::kPing, wire::Ping());
  EXPECT_TRUE(client.wait([&] { return client.pongs == 1; }));
}

TEST_F(ServerTest, AFullServerSaysSo) {
  ServerLimits limits;
  limits.sessions = 1;
  serve(limits);
  TestClient first(server->endpoint());
  ASSERT_TRUE(first.enter());
  TestClient second(server->endpoint());
  EXPECT_FALSE(second.enter());
  ASSERT_TRUE(second.go_away);
  EXPECT_GT(second.go_away->retry_after_ms(), 0u);
  EXPECT_EQ(server->metrics().refused_sessions, 1u);
}

TEST_F(ServerTest, DrainingSendsEveryoneAwayAndTakesNobody) {
  serve();
  TestClient client(server->endpoint());
  ASSERT_TRUE(client.enter());
  std::thread drain([&] { server->drain("maintenance", 2s); });
  EXPECT_TRUE(client.wait([&] { return client.closed.has_value(); }));
  drain.join();
  ASSERT_TRUE(client.go_away);
  EXPECT_EQ(client.go_away->reason(), "maintenance");
  EXPECT_EQ(server->metrics().open_sessions, 0);
  asio::io_context context;
  asio::ip::tcp::socket socket(context);
  asio::error_code error;
  socket.connect({asio::ip::make_address("127.0.0.1"), server->endpoint().port}, error);
  EXPECT_TRUE(error);
}

TEST_F(ServerTest, APortInUseAndScenesOfOneNameAreErrors) {
  serve();
  ServerOptions options;
  options.listen = server->endpoint();
  const auto scene = std::make_shared<FakeCellService>();
  const auto taken = Server::start(options, {scene});
  ASSERT_FALSE(taken);
  EXPECT_EQ(taken.error().code, ErrorCode::kUnavailable);
  options.listen->port = 0;
  const auto twice = Server::start(options, {scene, std::make_shared<FakeCellService>()});
  ASSERT_FALSE(twice);
  EXPECT_EQ(twice.error().code, ErrorCode::kInvalidArgument);
  EXPECT_FALSE(Server::start(options, {}));
}

TEST_F(ServerTest, StopsWithClientsConnected) {
  serve();
  TestClient client(server->endpoint());
  ASSERT_TRUE(client.enter());
  client.move_to({1, 1, 1});
  server.reset();
  EXPECT_TRUE(client.wait([&] { return client.closed.has_value(); }));
}

}  // namespace
}  // namespace farfield
