// SPDX-License-Identifier: Apache-2.0
// A client for tests: speaks the wire, keeps what it is sent, and runs in the test's own thread.
#pragma once

#include <gtest/gtest.h>

#include <asio/co_spawn.hpp>
#include <map>
#include <set>

#include "common/net/message.h"
#include "proto/farfield.pb.h"
#include "server/schedule/cell_service.h"
#include "tests/unit/common/net/loopback.h"

namespace farfield::test {

class TestClient {
 public:
  /// `tls`: null for a plain connection.
  explicit TestClient(const Endpoint& server, const TlsClient* tls = nullptr) {
    asio::ip::tcp::socket socket(context);
    socket.connect({asio::ip::make_address(server.host), server.port});
    ConnectionOptions options;
    options.receive_limits = kFromServerLimits;
    auto stream = tls ? std::make_shared<Stream>(*tls->wrap(std::move(socket))) : std::make_shared<Stream>(std::move(socket));
    std::optional<Status> shaken;
    asio::co_spawn(context, shake_hands(stream, false, std::chrono::seconds(5)),
                   [&shaken](std::exception_ptr, Status status) { shaken = std::move(status); });
    EXPECT_TRUE(run_until(context, [&] { return shaken.has_value(); }) && *shaken);
    connection = Connection::create(std::move(stream), options);
    ConnectionEvents events;
    events.on_frame = [this](IncomingFrame frame) { receive(std::move(frame)); };
    events.on_closed = [this](const Error& error) { closed = error; };
    connection->start(std::move(events));
  }
  ~TestClient() {
    cut();
    run_for(context, std::chrono::milliseconds(1));
  }

  // ── what it does ──
  static wire::Hello hello(const std::string& scene = "") {
    wire::Hello hello;
    hello.set_version_min(1);
    hello.set_version_max(1);
    hello.set_program("test");
    hello.set_scene(scene);
    return hello;
  }
  bool enter(const wire::Hello& message = hello()) {
    send(MessageType::kHello, message);
    return run_until(context, [&] { return welcome.has_value() || closed.has_value(); }) && welcome.has_value();
  }
  void send(MessageType type, const google::protobuf::MessageLite& message) { connection->send(make_message(type, message)); }
  void move_to(const glm::dvec3& viewpoint, double time_s = 0, bool wants_fallback = false) {
    const CellGrid grid{2.0};
    const CellId cell = grid.cell_at(viewpoint, 0);
    const glm::dvec3 offset = viewpoint - grid.box(cell).center();
    wire::Pose pose;
    pose.mutable_cell()->set_x(cell.x);
    pose.mutable_cell()->set_y(cell.y);
    pose.mutable_cell()->set_z(cell.z);
    pose.set_dx(static_cast<float>(offset.x));
    pose.set_dy(static_cast<float>(offset.y));
    pose.set_dz(static_cast<float>(offset.z));
    pose.set_qw(1);
    pose.set_time_s(time_s);
    pose.set_sequence(++poses);
    pose.set_wants_fallback(wants_fallback);
    pose.set_awaits_leaf_set(awaits_leaf_set);
    send(MessageType::kPose, pose);
  }
  void cut() { connection->close({ErrorCode::kCancelled, "cut"}); }
  bool wait(const std::function<bool()>& done) { return run_until(context, done); }
  bool wait_complete(std::size_t sets) {
    return wait([&] { return complete.size() >= sets; });
  }
  void idle(std::chrono::milliseconds time) { run_for(context, time); }

  // ── what it saw ──
  std::vector<ContentHash> held() const {
    std::vector<ContentHash> keys;
    for (const auto& [key, times] : received) keys.push_back(key);
    return keys;
  }
  std::size_t payloads() const { return order.size(); }
  std::size_t repeated() const {
    return static_cast<std::size_t>(std::count_if(received.begin(), received.end(), [](const auto& r) { return r.second > 1; }));
  }

  asio::io_context context;
  std::shared_ptr<Connection> connection;
  std::optional<Error> closed;
  std::optional<wire::Welcome> welcome;
  std::optional<wire::Failure> failure;
  std::optional<wire::GoAway> go_away;
  std::vector<wire::LeafSet> sets;
  std::vector<std::uint64_t> complete;
  std::map<ContentHash, int> received;       // payload key → times
  std::vector<std::pair<std::uint16_t, ContentHash>> order;  // message type and key, as they came
  std::set<ContentHash> empty_tiles;
  std::uint64_t poses = 0, frames = 0, pongs = 0;
  bool awaits_leaf_set = false;  // what its poses say

 private:
  template <class Message>
  Message parse(const IncomingFrame& frame) {
    const Result<Message> message = parse_message<Message>(frame);
    EXPECT_TRUE(message);
    return message ? *message : Message();
  }
  void note_payload(const IncomingFrame& frame, ContentHash key) {
    ++received[key];
    order.emplace_back(frame.type, key);
  }
  void receive(IncomingFrame frame) {
    ++frames;
    switch (static_cast<MessageType>(frame.type)) {
      case MessageType::kWelcome: welcome = parse<wire::Welcome>(frame); break;
      case MessageType::kFailure: failure = parse<wire::Failure>(frame); break;
      case MessageType::kGoAway: go_away = parse<wire::GoAway>(frame); break;
      case MessageType::kLeafSet: sets.push_back(parse<wire::LeafSet>(frame)); break;
      case MessageType::kLeafSetComplete: complete.push_back(parse<wire::LeafSetComplete>(frame).serial()); break;
      case MessageType::kTilePayload: {
        const ContentHash key = parse<wire::TilePayload>(frame).key();
        note_payload(frame, key);
        if (!frame.payload) empty_tiles.insert(key);
        break;
      }
      case MessageType::kChunkPayload: note_payload(frame, parse<wire::ChunkPayload>(frame).hash()); break;
      case MessageType::kTexturePayload: note_payload(frame, parse<wire::TexturePayload>(frame).key()); break;
      case MessageType::kPong: ++pongs; break;
      default: break;
    }
  }
};

}  // namespace farfield::test
