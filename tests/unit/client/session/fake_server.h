// SPDX-License-Identifier: Apache-2.0
// A server for tests: speaks the protocol over a real loopback socket and does only what the test tells it to.
// One thread of its own; every function may be called from the test's thread.
#pragma once

#include <asio/co_spawn.hpp>
#include <asio/detached.hpp>
#include <asio/executor_work_guard.hpp>
#include <asio/io_context.hpp>
#include <asio/post.hpp>
#include <asio/write.hpp>
#include <condition_variable>
#include <functional>
#include <future>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include "client/store/leaf_set.h"
#include "common/net/connect.h"
#include "common/net/connection.h"
#include "common/net/message.h"
#include "proto/farfield.pb.h"

namespace farfield::client {

class FakeServer {
 public:
  static constexpr std::chrono::seconds kPatience{5};

  FakeServer() : acceptor_(*listen_at(context_.get_executor(), Endpoint{"127.0.0.1", 0})) {
    welcome_.set_version(kProtocolVersionMax);
    welcome_.set_resume_token("token-1");
    welcome_.mutable_limits()->set_held(1000);
    welcome_.mutable_limits()->set_poses_per_second(60);
    wire::SceneInfo& scene = *welcome_.mutable_scene();
    scene.set_name("made up");
    scene.set_scene_hash(42);
    scene.mutable_origin()->set_x(1e6);
    scene.mutable_bounds_min();
    scene.mutable_bounds_max()->set_x(100);
    scene.mutable_start()->set_y(1.5);
    scene.set_finest_side_m(1);
    scene.set_kappa(2);
    accept();
    thread_ = std::thread([this] { context_.run(); });
  }
  ~FakeServer() {
    context_.stop();
    thread_.join();
  }

  Endpoint endpoint() const { return {"127.0.0.1", acceptor_.local_endpoint().port()}; }
  /// Change it before a client connects.
  wire::Welcome& welcome() { return welcome_; }
  /// Instead of a Welcome, answer Hello with these bytes as they are.
  void answer_hello_with(Bytes raw) { raw_answer_ = std::move(raw); }
  void answer_hello_with(OutgoingFrame frame) { frame_answer_ = std::move(frame); }

  /// Called on the server's thread for every pose. Set it before a client connects.
  void on_pose(std::function<void(const wire::Pose&)> react) { on_pose_ = std::move(react); }

  // ── what the client has sent ──
  template <class Message>
  std::vector<Message> received(MessageType type) const {
    const std::lock_guard lock(mutex_);
    std::vector<Message> messages;
    for (const IncomingFrame& frame : frames_) {
      if (frame.is(type)) messages.push_back(*parse_message<Message>(frame));
    }
    return messages;
  }
  /// Blocks until `count` messages of the type have come over all connections. Returns: whether they have.
  bool wait_for(MessageType type, std::size_t count) const {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, kPatience, [&] {
      return static_cast<std::size_t>(
                 std::count_if(frames_.begin(), frames_.end(), [&](const auto& f) { return f.is(type); })) >= count;
    });
  }

  // ── what the client is sent ──
  void send(OutgoingFrame frame) {
    asio::post(context_, [this, frame = std::move(frame)]() mutable {
      if (connection_) connection_->send(std::move(frame));
    });
  }
  void send_leaf_set(const LeafSet& set) {
    wire::LeafSet message;
    message.set_serial(set.serial);
    fill(*message.mutable_leaf(), set.leaf);
    fill(*message.mutable_root(), set.root);
    message.set_is_current(set.is_current);
    message.set_is_fallback(set.is_fallback);
    for (const ContentHash tile : set.tiles) message.add_tiles(tile);
    for (const LeafSetChunk& chunk : set.chunks) {
      wire::Placement& placement = *message.add_chunks();
      placement.set_chunk(chunk.chunk);
      placement.set_texture(chunk.texture);
      for (int i = 0; i < 3; ++i) placement.add_transform(chunk.cell_from_chunk[3][i]);
    }
    send(make_message(MessageType::kLeafSet, message));
  }
  void send_tile(ContentHash key, Bytes bytes = {1}) {
    wire::TilePayload message;
    message.set_key(key);
    send(make_message(MessageType::kTilePayload, message, std::make_shared<const Bytes>(std::move(bytes))));
  }
  void send_complete(std::uint64_t serial) {
    wire::LeafSetComplete message;
    message.set_serial(serial);
    send(make_message(MessageType::kLeafSetComplete, message));
  }
  void send_raw(const Bytes& bytes) {
    // An unframed write needs the socket itself; a frame whose head is overwritten does as well.
    OutgoingFrame frame;
    frame.head = bytes;
    send(std::move(frame));
  }
  /// Breaks the present connection.
  void cut() {
    asio::post(context_, [this] {
      if (connection_) connection_->close({ErrorCode::kCancelled, "cut"});
    });
  }
  /// Everything sent before has been handed to the socket.
  void sync() {
    std::promise<void> done;
    asio::post(context_, [&] { done.set_value(); });
    done.get_future().wait();
  }

 private:
  static void fill(wire::Cell& cell, const CellId& id) {
    cell.set_level(id.level);
    cell.set_x(id.x);
    cell.set_y(id.y);
    cell.set_z(id.z);
  }
  void accept() {
    acceptor_.async_accept([this](const asio::error_code& error, asio::ip::tcp::socket socket) {
      if (error) return;
      connection_ = Connection::create(std::move(socket), ConnectionOptions{});
      ConnectionEvents events;
      events.on_frame = [this](IncomingFrame frame) { receive(std::move(frame)); };
      connection_->start(std::move(events));
      accept();
    });
  }
  void receive(IncomingFrame frame) {
    if (frame.is(MessageType::kHello)) {
      if (raw_answer_) {
        OutgoingFrame raw;
        raw.head = *raw_answer_;
        connection_->send(std::move(raw));
      } else {
        connection_->send(frame_answer_ ? *frame_answer_ : make_message(MessageType::kWelcome, welcome_));
      }
    }
    if (frame.is(MessageType::kPing)) {
      const auto ping = *parse_message<wire::Ping>(frame);
      wire::Pong pong;
      pong.set_sequence(ping.sequence());
      pong.set_time_s(ping.time_s());
      connection_->send(make_message(MessageType::kPong, pong));
    }
    if (frame.is(MessageType::kPose) && on_pose_) on_pose_(*parse_message<wire::Pose>(frame));
    if (frame.is(MessageType::kBye)) connection_->close({ErrorCode::kCancelled, "bye"});
    const std::lock_guard lock(mutex_);
    frames_.push_back(std::move(frame));
    changed_.notify_all();
  }

  asio::io_context context_{1};
  asio::ip::tcp::acceptor acceptor_;
  wire::Welcome welcome_;
  std::optional<Bytes> raw_answer_;
  std::optional<OutgoingFrame> frame_answer_;
  std::function<void(const wire::Pose&)> on_pose_;
  std::shared_ptr<Connection> connection_;
  mutable std::mutex mutex_;  // guards frames_
  mutable std::condition_variable changed_;
  std::vector<IncomingFrame> frames_;
  std::thread thread_;
};

}  // namespace farfield::client
