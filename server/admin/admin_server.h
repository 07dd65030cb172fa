// SPDX-License-Identifier: Apache-2.0
// A small HTTP server for operators: /metrics, /healthz, /readyz. Not for the open network: it knows no passwords.
//
// Runs on one thread of its own, so it answers while everything else is busy. One request per connection, bounded in
// size and time.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "common/net/endpoint.h"

namespace farfield {

/// Called on the admin thread.
struct AdminPages {
  std::function<std::string()> metrics;  // Prometheus text
  std::function<std::string()> why_not_ready;  // empty: takes new viewers
};

class AdminServer {
 public:
  /// Errors: kNotFound, kUnavailable (the port is in use), kIo.
  static Result<std::unique_ptr<AdminServer>> start(const Endpoint& listen, AdminPages pages);
  ~AdminServer();

  Endpoint endpoint() const;

 private:
  struct State;
  explicit AdminServer(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

/// The whole response to one request, head and body. `request`: the request line without its end.
std::string admin_response(std::string_view request, const AdminPages& pages);

}  // namespace farfield
