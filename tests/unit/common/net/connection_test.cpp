// SPDX-License-Identifier: Apache-2.0
// Connections over real loopback sockets. Also guards against g++ 12 destroying frames twice inside coroutines.
#include "common/net/connection.h"

#include <gtest/gtest.h>

#include <asio/write.hpp>

#include "common/net/message.h"
#include "proto/farfield.pb.h"
#include "tests/unit/common/net/loopback.h"

namespace farfield {
namespace {

using namespace std::chrono_literals;
using test::run_for;
using test::run_until;

class ConnectionTest : public ::testing::Test {
 protected:
  ConnectionTest() {
    auto sockets = test::connected_sockets(context);
    ConnectionOptions options;
    options.receive_limits = FrameLimits{1000, 1 << 20};
    options.outbox_bytes = 100000;
    left = Connection::create(std::move(sockets.first), options);
    right_socket = std::make_unique<asio::ip::tcp::socket>(std::move(sockets.second));
    left->start(left_seen.events());
  }
  void start_right() {
    ConnectionOptions options;
    options.receive_limits = kFromServerLimits;
    right = Connection::create(std::move(*right_socket), options);
    right->start(right_seen.events());
  }
  ~ConnectionTest() override {
    for (const auto& connection : {left, right}) {
      if (connection) connection->close({ErrorCode::kCancelled, "test over"});
    }
    run_for(context, 1ms);
  }

  asio::io_context context;
  test::Observer left_seen, right_seen;
  std::shared_ptr<Connection> left, right;
  std::unique_ptr<asio::ip::tcp::socket> right_socket;
};

TEST_F(ConnectionTest, MessagesArriveWithTheirPayloadsAndAreCounted) {
  start_right();
  wire::TilePayload message;
  message.set_key(0x1234567890abcdef);
  const auto payload = std::make_shared<const Bytes>(Bytes(300000, 42));
  const std::weak_ptr<const Bytes> watch = payload;
  EXPECT_TRUE(left->send(make_message(MessageType::kTilePayload, message, payload), Lane::kPayload));
  EXPECT_TRUE(left->send(make_message(MessageType::kTilePayload, message)));
  ASSERT_TRUE(run_until(context, [&] { return right_seen.frames.size() == 2; }));
  EXPECT_EQ(right_seen.frames[0].payload, nullptr) << "control goes first";
  ASSERT_TRUE(right_seen.frames[1].payload);
  EXPECT_EQ(*right_seen.frames[1].payload, *payload);
  const auto parsed = parse_message<wire::TilePayload>(right_seen.frames[1]);
  ASSERT_TRUE(parsed);
  EXPECT_EQ(parsed->key(), 0x1234567890abcdef);
  ASSERT_TRUE(run_until(context, [&] { return left->counters().frames_out == 2; }));
  EXPECT_EQ(left->counters().bytes_out, right->counters().bytes_in);
  EXPECT_EQ(right->counters().frames_in, 2u);
  EXPECT_GE(left_seen.drained, 1);
  EXPECT_EQ(payload.use_count(), 1) << "nobody holds a written payload, and nobody released it twice";
}

TEST_F(ConnectionTest, ManyFramesKeepTheirOrder) {
  start_right();
  for (std::uint64_t i = 0; i < 2000; ++i) {
    wire::Ping ping;
    ping.set_sequence(i);
    ASSERT_TRUE(left->send(make_message(MessageType::kPing, ping)));
  }
  ASSERT_TRUE(run_until(context, [&] { return right_seen.frames.size() == 2000; }));
  for (std::uint64_t i = 0; i < 2000; ++i) {
    const auto ping = parse_message<wire::Ping>(right_seen.frames[i]);
    ASSERT_TRUE(ping);
    EXPECT_EQ(ping->sequence(), i);
  }
}

TEST_F(ConnectionTest, APeerThatDoesNotReadMeetsBackPressureNotMemory) {
  // Nobody reads the other socket: the kernel's buffers fill, then the outbox, then send() says no.
  const auto payload = std::make_shared<const Bytes>(Bytes(50000, 1));
  std::size_t accepted = 0;
  for (int i = 0; i < 2000; ++i) {
    accepted += left->send(make_frame(MessageType::kTilePayload, {}, payload), Lane::kPayload) ? 1 : 0;
    context.poll();
    context.restart();
  }
  EXPECT_LT(accepted, 2000u);
  EXPECT_LE(left->queued_bytes(), 100000u + 60000u);
  run_for(context, 30ms);
  EXPECT_GT(left->write_stalled(), 10ms);
  EXPECT_TRUE(left->is_open());
}

TEST_F(ConnectionTest, AFloodOfControlFramesToADeafPeerClosesTheConnection) {
  const Bytes message(60000, 7);
  bool open = true;
  for (int i = 0; i < 2000 && open; ++i) {
    open = left->send(make_frame(MessageType::kPong, message));
    context.poll();
    context.restart();
  }
  EXPECT_FALSE(open);
  run_for(context, 1ms);
  ASSERT_EQ(left_seen.closings.size(), 1u);
  EXPECT_EQ(left_seen.closings[0].code, ErrorCode::kLimitExceeded);
}

TEST_F(ConnectionTest, GarbageIsReportedOnceAndTheLastWordStillArrives) {
  test::Observer seen;
  ConnectionEvents events = seen.events();
  auto [near, far] = test::connected_sockets(context);
  const auto connection = Connection::create(std::move(near), ConnectionOptions{});
  events.on_bad_stream = [&](const Error& error) {
    seen.bad_streams.push_back(error);
    wire::Failure failure;
    failure.set_message("no frame");
    connection->send(make_message(MessageType::kFailure, failure));
    connection->close_after_flush(error, 500ms);
  };
  connection->start(events);
  asio::write(far, asio::buffer(Bytes(100000, 'x')));
  right_socket = std::make_unique<asio::ip::tcp::socket>(std::move(far));
  start_right();
  ASSERT_TRUE(run_until(context, [&] { return !right_seen.closings.empty() && !seen.closings.empty(); }));
  ASSERT_EQ(seen.bad_streams.size(), 1u);
  EXPECT_EQ(seen.bad_streams[0].code, ErrorCode::kBadData);
  ASSERT_EQ(right_seen.frames.size(), 1u);
  EXPECT_TRUE(right_seen.frames[0].is(MessageType::kFailure));
  EXPECT_EQ(seen.closings[0].code, ErrorCode::kBadData);
}

TEST_F(ConnectionTest, HalfAFrameThenTheEndIsABrokenConnection) {
  const OutgoingFrame frame = make_frame(MessageType::kPose, Bytes(100));
  asio::write(*right_socket, asio::buffer(frame.head.data(), 50));
  run_for(context, 10ms);
  EXPECT_TRUE(left->is_open()) << "half a frame is only the beginning of one";
  right_socket->close();
  ASSERT_TRUE(run_until(context, [&] { return !left_seen.closings.empty(); }));
  EXPECT_EQ(left_seen.closings[0].code, ErrorCode::kIo);
  EXPECT_TRUE(left_seen.frames.empty());
}

TEST_F(ConnectionTest, AnOrderlyEndIsNoError) {
  right_socket->close();
  ASSERT_TRUE(run_until(context, [&] { return !left_seen.closings.empty(); }));
  EXPECT_EQ(left_seen.closings[0].code, ErrorCode::kUnavailable);
  EXPECT_EQ(left_seen.closings.size(), 1u);
}

TEST_F(ConnectionTest, ClosingInsideAnEventIsSafe) {
  auto [near, far] = test::connected_sockets(context);
  std::weak_ptr<Connection> watch;
  int frames = 0, closings = 0;
  {
    const auto connection = Connection::create(std::move(near), ConnectionOptions{});
    watch = connection;
    ConnectionEvents events;
    events.on_frame = [&frames, connection](IncomingFrame) {
      ++frames;
      connection->close({ErrorCode::kCancelled, "enough"});
    };
    events.on_closed = [&closings](const Error&) { ++closings; };
    connection->start(std::move(events));
  }
  const OutgoingFrame frame = make_frame(MessageType::kPing, {});
  for (int i = 0; i < 3; ++i) asio::write(far, asio::buffer(frame.head));
  ASSERT_TRUE(run_until(context, [&] { return watch.expired(); })) << "closing breaks the cycle of ownership";
  EXPECT_EQ(frames, 1);
  EXPECT_EQ(closings, 1);
}

}  // namespace
}  // namespace farfield
