// SPDX-License-Identifier: Apache-2.0
// HOST:PORT as it stands on command lines and in logs.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "common/base/result.h"

namespace farfield {

inline constexpr std::uint16_t kDefaultPort = 7400;

struct Endpoint {
  std::string host = "127.0.0.1";
  std::uint16_t port = kDefaultPort;
};

/// "host:port", "host" (the default port), "[::1]:7400", ":7400" (this machine). Errors: kInvalidArgument.
Result<Endpoint> parse_endpoint(std::string_view text);
/// IPv6 addresses in brackets.
std::string to_string(const Endpoint& endpoint);

}  // namespace farfield
