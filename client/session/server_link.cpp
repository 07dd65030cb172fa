// SPDX-License-Identifier: Apache-2.0
#include "client/session/server_link.h"

#include <algorithm>
#include <asio/co_spawn.hpp>
#include <asio/detached.hpp>
#include <asio/redirect_error.hpp>
#include <asio/use_awaitable.hpp>
#include <random>
#include <utility>

#include "client/session/wire_convert.h"
#include "common/net/connect.h"
#include "common/net/message.h"
#include "proto/farfield.pb.h"

namespace farfield::client {
namespace {

using Milliseconds = std::chrono::milliseconds;

/// Longest time between two attempts that a server may ask for.
constexpr Milliseconds kLongestRetryAfter{60000};
/// A stream that makes no sense this often in a row will not make sense the next time.
constexpr int kMostBadStreams = 3;
constexpr std::chrono::seconds kLongEnoughToHaveWorked{10};
constexpr std::size_t kMostHeldHashes = 100'000;  // 0.8 MB: below the largest message a server accepts

double seconds_now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

std::uint64_t random_seed() {
  std::random_device device;
  return (std::uint64_t{device()} << 32) | device();
}

bool is_bad_stream(ErrorCode code) { return code == ErrorCode::kBadData || code == ErrorCode::kLimitExceeded; }

}  // namespace

ServerLink::ServerLink(asio::io_context& context, const ClientOptions& options, Events events)
    : context_(context),
      options_(options),
      events_(std::move(events)),
      closed_(context),
      heart_(context),
      pause_(context),
      backoff_(random_seed()) {}

void ServerLink::start() { asio::co_spawn(context_, run(shared_from_this()), asio::detached); }

void ServerLink::stop() {
  if (is_stopping_) return;
  is_stopping_ = true;
  pause_.cancel();
  if (connection_) {
    wire::Bye bye;
    bye.set_reason("the viewer has left");
    connection_->send(make_message(MessageType::kBye, bye));
    connection_->close_after_flush({ErrorCode::kCancelled, "closed by the client"}, Milliseconds(500));
  }
}

void ServerLink::send(OutgoingFrame frame) {
  if (is_welcome_ && connection_) connection_->send(std::move(frame));
}

std::uint64_t ServerLink::bytes_in() const {
  return past_bytes_in_ + (connection_ ? connection_->counters().bytes_in.load(std::memory_order_relaxed) : 0);
}

std::uint64_t ServerLink::bytes_out() const {
  return past_bytes_out_ + (connection_ ? connection_->counters().bytes_out.load(std::memory_order_relaxed) : 0);
}

asio::awaitable<void> ServerLink::run(std::shared_ptr<ServerLink> self) {
  asio::error_code ignored;
  while (!self->is_stopping_) {
    Result<std::shared_ptr<Stream>> stream = co_await open_stream(self);
    if (self->is_stopping_) break;
    if (stream) {
      self->start_session(std::move(*stream));
      self->closed_.expires_at(std::chrono::steady_clock::time_point::max());
      if (self->connection_) co_await self->closed_.async_wait(asio::redirect_error(asio::use_awaitable, ignored));
    } else {
      self->last_error_ = std::move(stream.error());
    }
    if (self->is_stopping_) break;
    if (self->is_final(self->last_error_)) {
      self->set_state(ClientState::kFailed, self->last_error_);
      co_return;
    }
    self->set_state(self->was_welcome_ ? ClientState::kReconnecting : ClientState::kConnecting, self->last_error_);
    self->pause_.expires_after(self->backoff_.next(std::exchange(self->retry_after_, Milliseconds(0))));
    co_await self->pause_.async_wait(asio::redirect_error(asio::use_awaitable, ignored));
  }
  const Error stopped{ErrorCode::kCancelled, ""};
  self->set_state(ClientState::kStopped, stopped);
}

asio::awaitable<Result<std::shared_ptr<Stream>>> ServerLink::open_stream(std::shared_ptr<ServerLink> self) {
  const ClientOptions& options = self->options_;
  Result<asio::ip::tcp::socket> socket = co_await connect_to(self->context_.get_executor(), options.server, options.connect_timeout);
  if (!socket) co_return tl::unexpected(std::move(socket.error()));
  if (!options.tls) co_return std::make_shared<Stream>(std::move(*socket));
  Result<TlsSocketPointer> secure = options.tls->wrap(std::move(*socket));
  if (!secure) co_return tl::unexpected(std::move(secure.error()));
  auto stream = std::make_shared<Stream>(std::move(*secure));
  const Status shaken = co_await shake_hands(stream, false, options.connect_timeout);
  if (!shaken) co_return fail_within(options.tls->host(), shaken.error());
  co_return stream;
}

void ServerLink::start_session(std::shared_ptr<Stream> stream) {
  ConnectionOptions connection_options;
  connection_options.receive_limits = kFromServerLimits;
  is_welcome_ = false;
  is_leaving_ = false;
  is_refused_ = false;
  const std::shared_ptr<Connection> connection = Connection::create(std::move(stream), connection_options);
  connection_ = connection;
  ConnectionEvents events;
  // The connection drops its events when it closes, so this is no cycle.
  const auto self = shared_from_this();
  events.on_frame = [self](IncomingFrame frame) { self->receive(std::move(frame)); };
  events.on_closed = [self](const Error& reason) { self->note_closed(reason); };
  connection->start(std::move(events));

  wire::Hello hello;
  hello.set_version_min(kProtocolVersionMin);
  hello.set_version_max(kProtocolVersionMax);
  hello.set_program(options_.program);
  hello.set_scene(options_.scene);
  hello.mutable_display()->set_width(static_cast<std::uint32_t>(options_.display.width));
  hello.mutable_display()->set_height(static_cast<std::uint32_t>(options_.display.height));
  hello.mutable_display()->set_fovy_rad(options_.display.fovy_rad);
  hello.set_resume_token(resume_token_);
  for (const ContentHash key : events_.held(std::min(held_limit_, kMostHeldHashes))) hello.add_held(key);
  hello.set_store_bytes(options_.store_bytes);
  hello.set_access_token(options_.access_token);
  connection->send(make_message(MessageType::kHello, hello));
  asio::co_spawn(context_, beat(self, connection), asio::detached);
}

asio::awaitable<void> ServerLink::beat(std::shared_ptr<ServerLink> self, std::shared_ptr<Connection> connection) {
  asio::error_code ignored;
  while (connection->is_open()) {
    self->heart_.expires_after(self->options_.heartbeat);
    co_await self->heart_.async_wait(asio::redirect_error(asio::use_awaitable, ignored));
    if (!connection->is_open()) break;
    if (connection->since_received() > 3 * self->options_.heartbeat) {
      Error silence{ErrorCode::kUnavailable, to_string(self->options_.server) + " has fallen silent"};
      connection->close(std::move(silence));
    } else if (self->is_welcome_) {
      self->ping();
    }
  }
}

void ServerLink::ping() {
  wire::Ping ping;
  ping.set_sequence(++pings_);
  ping.set_time_s(seconds_now());
  send(make_message(MessageType::kPing, ping));
}

void ServerLink::receive(IncomingFrame frame) {
  const Status status = handle(std::move(frame));
  if (!status && connection_) connection_->close(status.error());
}

Status ServerLink::handle(IncomingFrame frame) {
  switch (static_cast<MessageType>(frame.type)) {
    case MessageType::kWelcome: return handle_welcome(frame);
    case MessageType::kFailure: return handle_failure(frame);
    case MessageType::kGoAway: return handle_go_away(frame);
    case MessageType::kPing: {
      const Result<wire::Ping> ping = parse_message<wire::Ping>(frame);
      if (!ping) return tl::unexpected(ping.error());
      wire::Pong pong;
      pong.set_sequence(ping->sequence());
      pong.set_time_s(ping->time_s());
      if (connection_) connection_->send(make_message(MessageType::kPong, pong));
      return {};
    }
    case MessageType::kPong: {
      const Result<wire::Pong> pong = parse_message<wire::Pong>(frame);
      if (!pong) return tl::unexpected(pong.error());
      if (pong->sequence() == pings_) events_.on_round_trip(seconds_now() - pong->time_s());
      return {};
    }
    default: break;
  }
  if (!is_welcome_) {
    return fail(ErrorCode::kBadData, "{} does not speak Farfield: its first frame is of type {}, not a welcome",
                to_string(options_.server), frame.type);
  }
  return events_.on_frame(std::move(frame));
}

Status ServerLink::handle_welcome(const IncomingFrame& frame) {
  const Result<wire::Welcome> welcome = parse_message<wire::Welcome>(frame);
  if (!welcome) return tl::unexpected(welcome.error());
  if (welcome->version() < kProtocolVersionMin || welcome->version() > kProtocolVersionMax) {
    return fail(ErrorCode::kVersionMismatch, "{} speaks version {} of the protocol, this program {} to {}: update the older",
                to_string(options_.server), welcome->version(), kProtocolVersionMin, kProtocolVersionMax);
  }
  resume_token_ = welcome->resume_token();
  poses_per_second_ = welcome->limits().poses_per_second();
  held_limit_ = welcome->limits().held();
  is_welcome_ = true;
  if (Status status = events_.on_welcome(*welcome); !status) {
    is_welcome_ = false;
    return status;
  }
  was_welcome_ = true;
  backoff_.reset();
  last_error_ = {};
  welcome_time_ = std::chrono::steady_clock::now();
  set_state(ClientState::kStreaming, last_error_);
  ping();
  return {};
}

Status ServerLink::handle_failure(const IncomingFrame& frame) {
  const Result<wire::Failure> failure = parse_message<wire::Failure>(frame);
  if (!failure) return tl::unexpected(failure.error());
  Error error{to_error_code(failure->code()), fmt::format("{}: {}", to_string(options_.server), failure->message())};
  is_refused_ = failure->fatal();
  if (failure->fatal()) return tl::unexpected(std::move(error));
  set_state(is_welcome_ ? ClientState::kStreaming : ClientState::kConnecting, error);
  return {};
}

Status ServerLink::handle_go_away(const IncomingFrame& frame) {
  const Result<wire::GoAway> away = parse_message<wire::GoAway>(frame);
  if (!away) return tl::unexpected(away.error());
  if (!away->resume_token().empty()) resume_token_ = away->resume_token();
  retry_after_ = std::min<Milliseconds>(kLongestRetryAfter, Milliseconds(away->retry_after_ms()));
  is_leaving_ = true;
  last_error_ = {ErrorCode::kUnavailable,
                 fmt::format("{} asks to come back later: {}", to_string(options_.server), away->reason())};
  // The server goes on sending what it has begun and closes; what comes until then is welcome.
  set_state(ClientState::kReconnecting, last_error_);
  return {};
}

void ServerLink::note_closed(const Error& reason) {
  past_bytes_in_ += connection_->counters().bytes_in.load(std::memory_order_relaxed);
  past_bytes_out_ += connection_->counters().bytes_out.load(std::memory_order_relaxed);
  connection_ = nullptr;
  // After a GoAway the cut was announced; its reason says more than "closed the connection".
  if (!is_leaving_) last_error_ = reason;
  const bool has_worked = is_welcome_ && std::chrono::steady_clock::now() - welcome_time_ > kLongEnoughToHaveWorked;
  bad_streams_ = (has_worked ? 0 : bad_streams_) + (is_bad_stream(last_error_.code) ? 1 : 0);
  if (!is_welcome_ && last_error_.code == ErrorCode::kUnavailable && !is_leaving_) {
    last_error_.message += " before a welcome";
  }
  is_welcome_ = false;
  closed_.cancel();
  heart_.cancel();
}

bool ServerLink::is_final(const Error& error) const {
  switch (error.code) {
    case ErrorCode::kVersionMismatch:
    case ErrorCode::kUnauthenticated:
    case ErrorCode::kInvalidArgument: return true;
    // Names that vanish after a first success (a host during a failover) may come back.
    case ErrorCode::kNotFound: return !was_welcome_;
    case ErrorCode::kBadData: return !was_welcome_ || bad_streams_ >= kMostBadStreams;
    // Said by the server: it has no place for us now. Found here: frames too large to be Farfield's.
    case ErrorCode::kLimitExceeded: return !is_refused_ && (!was_welcome_ || bad_streams_ >= kMostBadStreams);
    default: return false;
  }
}

void ServerLink::set_state(ClientState state, const Error& error) { events_.on_state(state, error); }

}  // namespace farfield::client
