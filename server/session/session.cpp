// SPDX-License-Identifier: Apache-2.0
// Life and death of a session. What the messages mean: session_dispatch.cpp.
#include "server/session/session.h"

#include <asio/co_spawn.hpp>
#include <asio/detached.hpp>
#include <asio/post.hpp>
#include <asio/redirect_error.hpp>
#include <asio/use_awaitable.hpp>
#include <utility>

#include "common/net/message.h"
#include "proto/farfield.pb.h"
#include "server/session/session_messages.h"

namespace farfield {

Session::Session(std::shared_ptr<asio::io_context> context, std::shared_ptr<Connection> connection,
                 const SessionWorld& world, std::uint64_t first_serial, std::shared_ptr<ClientLimits::Visit> visit)
    : context_(std::move(context)),
      connection_(std::move(connection)),
      world_(world),
      first_serial_(first_serial),
      watch_timer_(connection_->executor()),
      pose_timer_(connection_->executor()),
      address_visit_(std::move(visit)),
      pose_rate_(world.limits.poses_per_second) {}

void Session::start(std::function<void()> on_closed) {
  on_closed_ = std::move(on_closed);
  const auto self = shared_from_this();
  ConnectionEvents events;
  events.on_frame = [self](IncomingFrame frame) { self->receive(std::move(frame)); };
  events.on_bad_stream = [self](const Error& error) {
    ++self->world_.metrics.bad_frames;
    self->refuse(error);
  };
  events.on_drained = [self] {
    if (self->pump_) self->pump_->pump();
  };
  events.on_closed = [self](const Error& reason) { self->close(reason); };
  connection_->start(std::move(events));
  asio::co_spawn(connection_->executor(), watch(self), asio::detached);
}

asio::awaitable<void> Session::watch(std::shared_ptr<Session> self) {
  asio::error_code ignored;
  while (self->connection_->is_open()) {
    const Clock::duration interval = std::min<Clock::duration>(std::chrono::seconds(1), self->world_.limits.ping_after / 4);
    self->watch_timer_.expires_after(interval);
    co_await self->watch_timer_.async_wait(asio::redirect_error(asio::use_awaitable, ignored));
    if (!self->connection_->is_open()) break;
    self->check_silence();
    if (self->pump_) self->pump_->retry_failed();
  }
}

void Session::check_silence() {
  const ServerLimits& limits = world_.limits;
  const Clock::time_point now = Clock::now();
  if (!service_ && now - started_ > limits.hello_timeout) {
    refuse({ErrorCode::kUnavailable, "no Hello arrived in time"});
    return;
  }
  if (admission_ && !world_.tokens->is_valid(*admission_)) {
    refuse(access_refused());
    return;
  }
  const Clock::duration silence = connection_->since_received();
  if (silence > limits.give_up_after || connection_->write_stalled() > limits.give_up_after) {
    connection_->close({ErrorCode::kUnavailable, "the client has fallen silent"});
    return;
  }
  if (service_ && silence > limits.ping_after && now - last_ping_ > limits.ping_after) {
    last_ping_ = now;
    wire::Ping ping;
    ping.set_sequence(++pings_);
    connection_->send(make_message(MessageType::kPing, ping));
  }
}

void Session::refuse(const Error& error) {
  log(fmt::format("refused: {}", error.message));
  connection_->discard(Lane::kPayload);
  connection_->discard(Lane::kPrefetch);
  connection_->send(failure_message(error, true));
  connection_->close_after_flush(error, std::chrono::seconds(2));
}

void Session::send_away(const Refusal& refusal) {
  ++world_.metrics.refused_sessions;
  log(fmt::format("sent away: {}", refusal.reason));
  connection_->send(go_away_message(refusal.reason, "", refusal.retry_after));
  connection_->close_after_flush({ErrorCode::kUnavailable, refusal.reason}, std::chrono::seconds(1));
}

void Session::drain(std::string reason, std::chrono::milliseconds grace) {
  asio::post(connection_->executor(), [self = shared_from_this(), reason = std::move(reason), grace] {
    if (!self->connection_->is_open()) return;
    constexpr std::chrono::milliseconds kRetryAfter{1000};
    self->connection_->send(go_away_message(reason, self->token_, kRetryAfter));
    self->connection_->close_after_flush({ErrorCode::kCancelled, reason}, grace);
  });
}

void Session::supersede() {
  asio::post(connection_->executor(), [self = shared_from_this()] {
    self->connection_->close({ErrorCode::kCancelled, "the client came back on another connection"});
  });
}

void Session::close(const Error& reason) {
  log(fmt::format("closed: {}", reason.message));
  if (pump_) pump_->stop();
  if (tracker_) tracker_->stop();
  if (!token_.empty()) world_.registry.close(token_, Clock::now());
  watch_timer_.cancel();
  pose_timer_.cancel();
  address_visit_.reset();
  token_visit_.reset();
  if (const auto closed = std::exchange(on_closed_, nullptr)) closed();
}

void Session::log(const std::string& what) const {
  if (!world_.log) return;
  world_.log(program_.empty() ? fmt::format("{} {}", connection_->peer(), what)
                              : fmt::format("{} ({}) {}", connection_->peer(), program_, what));
}

}  // namespace farfield
