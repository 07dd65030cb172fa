// SPDX-License-Identifier: Apache-2.0
// HOST:PORT as it stands on command lines and in logs.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "common/base/result.h"

namespace farfield {

inline constexpr std::uint16_t kDefaultPort = 7400;
inline constexpr std::uint16_t kDefaultTlsPort = 7443;

struct Endpoint {
  std::string host = "127.0.0.1";
  std::uint16_t port = kDefaultPort;
};

/// "host:port", "host" (the default port), "[::1]:7400", ":7400" (this machine). Errors: kInvalidArgument.
Result<Endpoint> parse_endpoint(std::string_view text, std::uint16_t default_port = kDefaultPort);
/// IPv6 addresses in brackets.
std::string to_string(const Endpoint& endpoint);
/// Nobody but programs on this machine can be there: 127.0.0.0/8, ::1, "localhost".
bool is_loopback(const Endpoint& endpoint);

/// A server as users name it.
struct ServerAddress {
  Endpoint endpoint;
  bool is_tls = false;
};

/// An endpoint, "farfield://" and an endpoint, or "farfields://" and an endpoint for TLS, whose default port differs.
/// Errors: kInvalidArgument.
Result<ServerAddress> parse_server_address(std::string_view text, bool is_tls = false);

}  // namespace farfield
