// SPDX-License-Identifier: Apache-2.0
//
// The coroutines are static functions that take a shared pointer by value, and every temporary inside a co_await
// expression is trivial or named: g++ 12 destroys aggregate temporaries in such expressions twice.
#include "common/net/connection.h"

#include <netinet/tcp.h>

#include <asio/buffer.hpp>
#include <asio/co_spawn.hpp>
#include <asio/detached.hpp>
#include <asio/post.hpp>
#include <asio/redirect_error.hpp>
#include <asio/use_awaitable.hpp>

#include "common/net/endpoint.h"

namespace farfield {
namespace {

constexpr std::size_t kWriteFrames = 32;                       // two buffers each: Asio gathers at most 64
constexpr std::size_t kWriteBytes = std::size_t{256} << 10;    // so that control frames never wait for much
// Unsent bytes the kernel takes from us: enough to keep the link busy between two wake-ups, little enough that
// what has become stale can still be withdrawn from the outbox.
constexpr int kUnsentBytes = 128 << 10;

/// Buffers over whole frames, advanced past what has been written.
class GatherList {
 public:
  explicit GatherList(const std::vector<OutgoingFrame>& frames) {
    for (const OutgoingFrame& frame : frames) {
      buffers_.emplace_back(frame.head.data(), frame.head.size());
      if (frame.payload && !frame.payload->empty()) buffers_.emplace_back(frame.payload->data(), frame.payload->size());
    }
  }
  bool is_done() const { return first_ == buffers_.size(); }
  std::vector<asio::const_buffer> remaining() const {
    return {buffers_.begin() + static_cast<std::ptrdiff_t>(first_), buffers_.end()};
  }
  void advance(std::size_t written) {
    while (written > 0 && written >= buffers_[first_].size()) written -= buffers_[first_++].size();
    if (written > 0) buffers_[first_] += written;
  }

 private:
  std::vector<asio::const_buffer> buffers_;
  std::size_t first_ = 0;
};

}  // namespace

Connection::Connection(std::shared_ptr<Stream> stream, const ConnectionOptions& options)
    : stream_(std::move(stream)),
      wake_writer_(executor()),
      grace_(executor()),
      decoder_(options.receive_limits),
      outbox_(options.outbox_bytes, options.control_outbox_bytes),
      counters_(std::make_unique<ConnectionCounters>()),
      totals_(options.totals) {}

void Connection::count(std::atomic<std::uint64_t> ConnectionCounters::* which, std::uint64_t amount) {
  ((*counters_).*which).fetch_add(amount, std::memory_order_relaxed);
  if (totals_) ((*totals_).*which).fetch_add(amount, std::memory_order_relaxed);
}

std::shared_ptr<Connection> Connection::create(std::shared_ptr<Stream> stream, const ConnectionOptions& options) {
  std::shared_ptr<Connection> connection(new Connection(std::move(stream), options));
  asio::ip::tcp::socket& socket = connection->stream_->socket();
  asio::error_code ignored;
  socket.set_option(asio::ip::tcp::no_delay(true), ignored);
  ::setsockopt(socket.native_handle(), IPPROTO_TCP, TCP_NOTSENT_LOWAT, &kUnsentBytes, sizeof kUnsentBytes);
  const asio::ip::tcp::endpoint peer = socket.remote_endpoint(ignored);
  connection->peer_ = ignored ? "unknown" : to_string(Endpoint{peer.address().to_string(), peer.port()});
  return connection;
}

void Connection::start(ConnectionEvents events) {
  events_ = std::make_shared<const ConnectionEvents>(std::move(events));
  asio::co_spawn(executor(), read_loop(shared_from_this()), asio::detached);
  asio::co_spawn(executor(), write_loop(shared_from_this()), asio::detached);
}

bool Connection::send(OutgoingFrame frame, Lane lane) {
  if (!is_open()) return false;
  if (!outbox_.push(std::move(frame), lane)) {
    // Not at once: whoever sends is in the middle of something that closing would pull away from under it.
    if (lane == Lane::kControl) {
      asio::post(executor(), [self = shared_from_this()] {
        self->close({ErrorCode::kLimitExceeded, self->peer_ + " does not read what it is sent"});
      });
    }
    return false;
  }
  wake_writer_.cancel();
  return true;
}

void Connection::close_after_flush(Error reason, std::chrono::milliseconds grace) {
  if (!is_open()) return;
  state_ = State::kFlushing;
  reason_ = std::move(reason);
  wake_writer_.cancel();
  asio::co_spawn(executor(), close_later(shared_from_this(), grace), asio::detached);
}

void Connection::close(Error reason) {
  if (state_ == State::kClosed) return;
  if (state_ == State::kOpen) reason_ = std::move(reason);
  state_ = State::kClosed;
  asio::error_code ignored;
  stream_->socket().close(ignored);
  wake_writer_.cancel();
  grace_.cancel();
  for (const Lane lane : {Lane::kControl, Lane::kPayload, Lane::kPrefetch}) outbox_.discard(lane);
  const auto events = std::exchange(events_, nullptr);
  if (events && events->on_closed) events->on_closed(reason_);
}

Connection::Clock::duration Connection::write_stalled() const {
  return write_progress_ == Clock::time_point{} ? Clock::duration::zero() : Clock::now() - write_progress_;
}

asio::awaitable<void> Connection::close_later(std::shared_ptr<Connection> self, std::chrono::milliseconds grace) {
  asio::error_code ignored;
  self->grace_.expires_after(grace);
  co_await self->grace_.async_wait(asio::redirect_error(asio::use_awaitable, ignored));
  self->close({ErrorCode::kCancelled, "closed"});
}

bool Connection::deliver_frames() {
  while (state_ == State::kOpen) {
    Result<std::optional<IncomingFrame>> frame = decoder_.next();
    if (!frame) {
      const auto events = events_;
      if (events && events->on_bad_stream) events->on_bad_stream(frame.error());
      if (state_ == State::kOpen) close(frame.error());
      break;
    }
    if (!frame->has_value()) return true;
    count(&ConnectionCounters::frames_in, 1);
    const auto events = events_;
    if (events && events->on_frame) events->on_frame(std::move(**frame));
  }
  return state_ != State::kClosed;
}

asio::awaitable<void> Connection::read_loop(std::shared_ptr<Connection> self) {
  Bytes thrown_away;
  while (self->state_ != State::kClosed) {
    std::span<std::uint8_t> target;
    if (self->state_ == State::kOpen) {
      target = self->decoder_.writable();
    } else {
      thrown_away.resize(std::size_t{16} << 10);
      target = thrown_away;
    }
    asio::error_code error;
    const bool was_open = self->is_open();
    const asio::mutable_buffer buffer(target.data(), target.size());
    const std::size_t size = co_await self->stream_->read_some(buffer, error);
    if (self->state_ == State::kClosed) break;
    if (error) {
      const bool is_cut = error != asio::error::eof || self->decoder_.is_within_frame();
      self->close({is_cut ? ErrorCode::kIo : ErrorCode::kUnavailable,
                   self->peer_ + (is_cut ? " broke the connection: " + error.message() : " closed the connection")});
      break;
    }
    self->count(&ConnectionCounters::bytes_in, size);
    self->last_received_ = Clock::now();
    if (!was_open) continue;
    self->decoder_.commit(size);
    if (!self->deliver_frames()) break;
  }
}

asio::awaitable<void> Connection::write_loop(std::shared_ptr<Connection> self) {
  asio::error_code error;
  while (self->state_ != State::kClosed) {
    const std::vector<OutgoingFrame> frames = self->outbox_.take(kWriteFrames, kWriteBytes);
    if (frames.empty()) {
      if (self->state_ == State::kFlushing) {
        // Everything is written. Closing now could reset the connection and lose it: wait until the peer closes too.
        if (self->stream_->is_tls()) co_await self->stream_->say_farewell(error);
        self->stream_->socket().shutdown(asio::ip::tcp::socket::shutdown_send, error);
        break;
      }
      self->wake_writer_.expires_at(Clock::time_point::max());
      co_await self->wake_writer_.async_wait(asio::redirect_error(asio::use_awaitable, error));
      continue;
    }
    GatherList gather(frames);
    self->write_progress_ = Clock::now();
    while (!gather.is_done() && self->state_ != State::kClosed) {
      const std::vector<asio::const_buffer> buffers = gather.remaining();
      const std::size_t written = co_await self->stream_->write_some(buffers, error);
      if (error && self->state_ != State::kClosed) {
        self->close({ErrorCode::kIo, self->peer_ + " broke the connection: " + error.message()});
      }
      if (self->state_ == State::kClosed) co_return;
      self->write_progress_ = Clock::now();
      self->count(&ConnectionCounters::bytes_out, written);
      gather.advance(written);
    }
    self->write_progress_ = {};
    self->count(&ConnectionCounters::frames_out, frames.size());
    const auto events = self->events_;
    if (self->has_room() && events && events->on_drained) events->on_drained();
  }
}

}  // namespace farfield
