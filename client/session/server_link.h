// SPDX-License-Identifier: Apache-2.0
// The way to the server: connects, says hello, keeps the connection alive, and comes back after a cut.
//
//   connecting ── Welcome ──> streaming ── cut, GoAway ──> reconnecting ── Welcome ──> streaming
//        └─ final failure ──────────────────> failed <──────────┘
//
// Handles Welcome, Failure, GoAway, Ping and Pong itself and hands every other frame on.
// Threads: everything on one io_context run by one thread, events included.
#pragma once

#include <asio/io_context.hpp>
#include <asio/steady_timer.hpp>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "client/session/backoff.h"
#include "client/session/client_options.h"
#include "client/session/client_status.h"
#include "common/net/connection.h"

namespace farfield::wire {
class Welcome;
}

namespace farfield::client {

class ServerLink : public std::enable_shared_from_this<ServerLink> {
 public:
  struct Events {
    /// An error ends the connection: the Welcome made no sense.
    std::function<Status(const wire::Welcome&)> on_welcome;
    /// An error ends the connection, which is then made anew.
    std::function<Status(IncomingFrame)> on_frame;
    std::function<void(ClientState, const Error&)> on_state;
    /// Payload keys held, at most `count`.
    std::function<std::vector<ContentHash>(std::size_t count)> held;
    std::function<void(double)> on_round_trip;  // seconds
  };

  ServerLink(asio::io_context& context, const ClientOptions& options, Events events);

  void start();
  /// Says Bye, closes and stays closed; on_state(kStopped) follows, at once if there is no connection.
  void stop();
  /// Dropped while there is no session.
  void send(OutgoingFrame frame);
  bool is_streaming() const { return is_welcome_; }
  /// Over all connections so far.
  std::uint64_t bytes_in() const;
  std::uint64_t bytes_out() const;
  /// From the last Welcome; 0 before it.
  std::uint32_t poses_per_second() const { return poses_per_second_; }
  std::size_t held_limit() const { return held_limit_; }

 private:
  static asio::awaitable<void> run(std::shared_ptr<ServerLink> self);
  static asio::awaitable<void> beat(std::shared_ptr<ServerLink> self, std::shared_ptr<Connection> connection);
  void ping();
  static asio::awaitable<Result<std::shared_ptr<Stream>>> open_stream(std::shared_ptr<ServerLink> self);
  void start_session(std::shared_ptr<Stream> stream);
  void receive(IncomingFrame frame);
  Status handle(IncomingFrame frame);
  Status handle_welcome(const IncomingFrame& frame);
  Status handle_failure(const IncomingFrame& frame);
  Status handle_go_away(const IncomingFrame& frame);
  void note_closed(const Error& reason);
  bool is_final(const Error& error) const;
  void set_state(ClientState state, const Error& error);

  asio::io_context& context_;
  const ClientOptions options_;
  Events events_;
  std::shared_ptr<Connection> connection_;
  asio::steady_timer closed_;   // waited on while a connection is open
  asio::steady_timer heart_;    // until the next ping
  asio::steady_timer pause_;    // between two attempts
  Backoff backoff_;
  Error last_error_;
  std::string resume_token_;
  std::chrono::milliseconds retry_after_{0};
  std::uint32_t poses_per_second_ = 0;
  std::size_t held_limit_ = 0;
  std::uint64_t past_bytes_in_ = 0, past_bytes_out_ = 0, pings_ = 0;
  std::chrono::steady_clock::time_point welcome_time_;
  int bad_streams_ = 0;         // in a row, without a session between them that lasted
  bool is_welcome_ = false;
  bool was_welcome_ = false;    // ever
  bool is_leaving_ = false;     // GoAway was received on this connection
  bool is_refused_ = false;     // the server ended this connection with a Failure
  bool is_stopping_ = false;
};

}  // namespace farfield::client
