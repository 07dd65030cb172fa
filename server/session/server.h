// SPDX-License-Identifier: Apache-2.0
// The server on the network: listens, gives every connection a session, and drains.
//
// Threads: `threads` network threads of its own; every function may be called from any other thread.
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/net/endpoint.h"
#include "common/net/tls.h"
#include "server/access/token_register.h"
#include "server/schedule/cell_service.h"
#include "server/session/server_limits.h"
#include "server/session/session_metrics.h"

namespace farfield {

struct ServerOptions {
  std::optional<Endpoint> listen = Endpoint{};  // plain; port 0: any free one; empty: TLS only
  std::optional<Endpoint> tls_listen;   // needs `tls`
  std::shared_ptr<TlsServer> tls;
  std::shared_ptr<TokenRegister> tokens;  // null: everybody may come in
  int threads = 1;                      // network threads: they only copy bytes and parse small messages
  ServerLimits limits;
  std::function<void(const std::string&)> log;  // one line per event; thread-safe; may be empty
};

class Server {
 public:
  /// Serves from its return on. `scenes`: by the names in their descriptions; the first is the default.
  /// Errors: kInvalidArgument (no scene, a name twice, nowhere to listen), kNotFound, kUnavailable (the port is in use), kIo.
  static Result<std::unique_ptr<Server>> start(ServerOptions options, std::vector<std::shared_ptr<CellService>> scenes);
  /// Cuts what is still connected.
  ~Server();

  /// Where it listens, with the actual ports: endpoint() is the plain one, or the only one.
  Endpoint endpoint() const;
  std::optional<Endpoint> tls_endpoint() const;
  const SessionMetrics& metrics() const;
  /// Why new viewers should go elsewhere, in a word or two; empty: they are welcome.
  std::string why_not_ready() const;
  /// Whether a network thread takes up work within this time. Blocks that long at most; not from a network thread.
  bool answers_within(std::chrono::milliseconds patience) const;
  /// From now on not ready, and nothing else: whoever still comes is served.
  void announce_drain();
  /// Takes no new connections, tells every client to come back later, and returns when all are gone or `grace` is
  /// over.
  void drain(const std::string& reason, std::chrono::milliseconds grace);

 private:
  struct State;
  explicit Server(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace farfield
