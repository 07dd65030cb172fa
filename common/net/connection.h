// SPDX-License-Identifier: Apache-2.0
// One connection that carries frames: a reader and a writer coroutine with an outbox between them.
//
// Threads: everything belongs to the executor of the socket, which must be a strand or an io_context run by one
// thread: call every function there, and events arrive there. Only `counters()` may be read from anywhere.
// Ownership: the coroutines keep the connection alive until it is closed; the events are dropped when it closes, so
// they may hold whoever owns the connection.
#pragma once

#include <asio/any_io_executor.hpp>
#include <asio/awaitable.hpp>
#include <asio/ip/tcp.hpp>
#include <asio/steady_timer.hpp>
#include <atomic>
#include <chrono>
#include <functional>
#include <memory>

#include "common/net/frame_decoder.h"
#include "common/net/outbox.h"
#include "common/net/stream.h"

namespace farfield {

struct ConnectionCounters {
  std::atomic<std::uint64_t> bytes_in{0}, bytes_out{0}, frames_in{0}, frames_out{0};
};

struct ConnectionOptions {
  FrameLimits receive_limits = kFromClientLimits;
  std::size_t outbox_bytes = std::size_t{512} << 10;         // payloads waiting in this process
  std::size_t control_outbox_bytes = std::size_t{16} << 20;  // control frames waiting: a peer that does not read
  std::shared_ptr<ConnectionCounters> totals;                // counted along, over many connections; may be null
};

struct ConnectionEvents {
  std::function<void(IncomingFrame)> on_frame;
  /// The bytes that arrive are no frames, or larger than allowed: nothing more is read. A chance to send a last word
  /// and close_after_flush(); without that the connection closes at once.
  std::function<void(const Error&)> on_bad_stream;
  /// The outbox has room for payloads again. May call send().
  std::function<void()> on_drained;
  /// Exactly once, last. kCancelled: closed from this side; kUnavailable: the peer closed between frames.
  std::function<void(const Error&)> on_closed;
};

class Connection : public std::enable_shared_from_this<Connection> {
 public:
  using Clock = std::chrono::steady_clock;

  /// Takes a connected stream over, one under TLS after its handshake.
  static std::shared_ptr<Connection> create(std::shared_ptr<Stream> stream, const ConnectionOptions& options);
  static std::shared_ptr<Connection> create(asio::ip::tcp::socket socket, const ConnectionOptions& options) {
    return create(std::make_shared<Stream>(std::move(socket)), options);
  }

  void start(ConnectionEvents events);
  /// Queues a frame. Returns: false if the lane is full or the connection is closing; a full control lane closes it
  /// soon after.
  bool send(OutgoingFrame frame, Lane lane = Lane::kControl);
  bool has_room() const { return is_open() && outbox_.has_room(); }
  /// Drops what waits in `lane`. Returns: the tags of the dropped frames.
  std::vector<std::uint64_t> discard(Lane lane) { return outbox_.discard(lane); }

  /// Writes what is queued, then closes; after `grace` it closes anyway. What arrives meanwhile is thrown away.
  void close_after_flush(Error reason, std::chrono::milliseconds grace = std::chrono::seconds(3));
  void close(Error reason);

  bool is_open() const { return state_ == State::kOpen; }
  const ConnectionCounters& counters() const { return *counters_; }
  std::size_t queued_bytes() const { return outbox_.bytes(); }
  std::size_t queued_control_bytes() const { return outbox_.bytes() - outbox_.payload_bytes(); }
  /// How long a write has waited for the peer without a byte of progress; zero while nothing is being written.
  Clock::duration write_stalled() const;
  Clock::duration since_received() const { return Clock::now() - last_received_; }
  asio::any_io_executor executor() { return stream_->socket().get_executor(); }
  /// "host:port" of the peer, for logs.
  const std::string& peer() const { return peer_; }

 private:
  enum class State { kOpen, kFlushing, kClosed };

  Connection(std::shared_ptr<Stream> stream, const ConnectionOptions& options);
  void count(std::atomic<std::uint64_t> ConnectionCounters::* which, std::uint64_t amount);
  static asio::awaitable<void> read_loop(std::shared_ptr<Connection> self);
  static asio::awaitable<void> write_loop(std::shared_ptr<Connection> self);
  static asio::awaitable<void> close_later(std::shared_ptr<Connection> self, std::chrono::milliseconds grace);
  /// Hands out whole frames. Returns: false when the connection must not read on.
  bool deliver_frames();

  std::shared_ptr<Stream> stream_;
  asio::steady_timer wake_writer_;
  asio::steady_timer grace_;
  FrameDecoder decoder_;
  Outbox outbox_;
  State state_ = State::kOpen;
  Error reason_;
  std::shared_ptr<const ConnectionEvents> events_;
  std::unique_ptr<ConnectionCounters> counters_;
  std::shared_ptr<ConnectionCounters> totals_;
  Clock::time_point last_received_ = Clock::now();
  Clock::time_point write_progress_{};  // zero: nothing is being written
  std::string peer_;
};

}  // namespace farfield
