// SPDX-License-Identifier: Apache-2.0
// A loopback TCP proxy that behaves like a link: for tests and benchmarks without privileges.
//
// Every connection is a viewer with a link of its own; the model holds in each direction. Bytes keep their order.
// What is under way is bounded by the bandwidth-delay product plus a few packets, so a sender feels the link's
// back-pressure and not the proxy's memory.
#pragma once

#include <cstdint>
#include <memory>

#include "common/net/endpoint.h"
#include "common/net/link_model.h"

namespace farfield {

class LinkProxy {
 public:
  /// Listens on a free loopback port and passes everything on to `target`. Runs on its own thread until destroyed.
  /// Errors: kUnavailable, kIo.
  static Result<std::unique_ptr<LinkProxy>> start(const Endpoint& target, const LinkModel& model,
                                                  std::uint64_t seed = 1);
  /// Cuts every connection.
  ~LinkProxy();

  /// Where clients connect to.
  Endpoint endpoint() const;

  // ── from any thread ──
  /// Breaks all present connections at once, losing what is under way; later ones work.
  void cut();
  /// While refusing, new connections are closed at once: the network is down.
  void set_refusing(bool refusing);
  /// Bytes delivered to the target and back to clients, over all connections so far.
  std::uint64_t bytes_to_target() const;
  std::uint64_t bytes_to_clients() const;

 private:
  struct State;
  explicit LinkProxy(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace farfield
