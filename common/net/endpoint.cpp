// SPDX-License-Identifier: Apache-2.0
#include "common/net/endpoint.h"

#include <algorithm>
#include <asio/ip/address.hpp>
#include <charconv>

namespace farfield {

Result<Endpoint> parse_endpoint(std::string_view text, std::uint16_t default_port) {
  Endpoint endpoint;
  endpoint.port = default_port;
  std::string_view host = text, port;
  bool has_port = false;
  if (!text.empty() && text.front() == '[') {
    const std::size_t close = text.find(']');
    if (close == std::string_view::npos) {
      return fail(ErrorCode::kInvalidArgument, "'{}': an IPv6 address ends with ']', as in [::1]:7400", text);
    }
    host = text.substr(1, close - 1);
    const std::string_view rest = text.substr(close + 1);
    has_port = !rest.empty() && rest.front() == ':';
    if (!rest.empty() && !has_port) {
      return fail(ErrorCode::kInvalidArgument, "'{}': after ']' comes ':' and a port", text);
    }
    port = has_port ? rest.substr(1) : rest;
  } else if (std::count(text.begin(), text.end(), ':') == 1) {
    const std::size_t colon = text.find(':');
    host = text.substr(0, colon);
    port = text.substr(colon + 1);
    has_port = true;
  }
  if (has_port) {
    const auto [end, error] = std::from_chars(port.data(), port.data() + port.size(), endpoint.port);
    if (error != std::errc() || end != port.data() + port.size() || port.empty()) {
      return fail(ErrorCode::kInvalidArgument, "'{}': the port must be a number from 0 to 65535", text);
    }
  }
  if (!host.empty()) endpoint.host = host;
  if (text.empty()) return fail(ErrorCode::kInvalidArgument, "an empty address: write HOST:PORT");
  return endpoint;
}

bool is_loopback(const Endpoint& endpoint) {
  asio::error_code error;
  const asio::ip::address address = asio::ip::make_address(endpoint.host, error);
  return endpoint.host == "localhost" || (!error && address.is_loopback());
}

Result<ServerAddress> parse_server_address(std::string_view text, bool is_tls) {
  constexpr std::string_view kPlain = "farfield://", kSecure = "farfields://";
  if (text.starts_with(kSecure)) {
    is_tls = true;
    text.remove_prefix(kSecure.size());
  } else if (text.starts_with(kPlain)) {
    if (is_tls) return fail(ErrorCode::kInvalidArgument, "'{}' is a plain connection, and --tls asks for TLS: write farfields://", text);
    text.remove_prefix(kPlain.size());
  }
  if (text.ends_with('/')) text.remove_suffix(1);
  const Result<Endpoint> endpoint = parse_endpoint(text, is_tls ? kDefaultTlsPort : kDefaultPort);
  if (!endpoint) return tl::unexpected(endpoint.error());
  return ServerAddress{*endpoint, is_tls};
}

std::string to_string(const Endpoint& endpoint) {
  const bool is_v6 = endpoint.host.find(':') != std::string::npos;
  return is_v6 ? fmt::format("[{}]:{}", endpoint.host, endpoint.port) : fmt::format("{}:{}", endpoint.host, endpoint.port);
}

}  // namespace farfield
