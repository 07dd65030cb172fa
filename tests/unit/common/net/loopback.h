// SPDX-License-Identifier: Apache-2.0
// Real loopback connections in one test thread: pairs of connected sockets, and running until something happens.
#pragma once

#include <asio/io_context.hpp>
#include <asio/ip/tcp.hpp>
#include <chrono>
#include <functional>
#include <utility>
#include <vector>

#include "common/net/connection.h"

namespace farfield::test {

/// Runs the context until `done` or the (generous) time is over. Returns: done().
inline bool run_until(asio::io_context& context, const std::function<bool()>& done,
                      std::chrono::milliseconds timeout = std::chrono::seconds(5)) {
  const auto end = std::chrono::steady_clock::now() + timeout;
  while (!done() && std::chrono::steady_clock::now() < end) {
    context.restart();
    context.run_one_for(std::chrono::milliseconds(5));
  }
  return done();
}

inline void run_for(asio::io_context& context, std::chrono::milliseconds time) {
  run_until(context, [] { return false; }, time);
}

inline std::pair<asio::ip::tcp::socket, asio::ip::tcp::socket> connected_sockets(asio::io_context& context) {
  using asio::ip::tcp;
  tcp::acceptor acceptor(context, tcp::endpoint(asio::ip::address_v4::loopback(), 0));
  tcp::socket first(context), second(context);
  first.connect(acceptor.local_endpoint());
  acceptor.accept(second);
  return {std::move(first), std::move(second)};
}

/// What one side of a connection has seen.
struct Observer {
  std::vector<IncomingFrame> frames;
  std::vector<Error> bad_streams, closings;
  int drained = 0;

  ConnectionEvents events() {
    ConnectionEvents events;
    events.on_frame = [this](IncomingFrame frame) { frames.push_back(std::move(frame)); };
    events.on_bad_stream = [this](const Error& error) { bad_streams.push_back(error); };
    events.on_drained = [this] { ++drained; };
    events.on_closed = [this](const Error& error) { closings.push_back(error); };
    return events;
  }
};

}  // namespace farfield::test
