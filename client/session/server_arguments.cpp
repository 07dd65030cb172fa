// SPDX-License-Identifier: Apache-2.0
#include "client/session/server_arguments.h"

#include <algorithm>
#include <cstdlib>
#include <fstream>

namespace farfield::client {
namespace {

constexpr std::size_t kLongestToken = 256;
constexpr const char* kTokenVariable = "FARFIELD_TOKEN";

/// The message never repeats what was read.
Result<std::string> checked_token(const std::string& source, std::string token) {
  while (!token.empty() && (token.back() == '\n' || token.back() == '\r' || token.back() == ' ')) token.pop_back();
  const bool is_printable = std::all_of(token.begin(), token.end(), [](char c) { return c > 0x20 && c < 0x7f; });
  if (token.empty() || token.size() > kLongestToken || !is_printable) {
    return fail(ErrorCode::kBadData, "{} holds no access token: one line of printable characters", source);
  }
  return token;
}

Result<std::string> read_token(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in) return fail(ErrorCode::kNotFound, "--token-file: {} cannot be read", file);
  std::string text(kLongestToken + 2, '\0');
  in.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(in.gcount()));
  return checked_token("--token-file: " + file, std::move(text));
}

}  // namespace

void ServerArguments::add_to(CLI::App& app) {
  app.add_option("--connect", connect_, "Server, HOST:PORT, or farfields://HOST:PORT through TLS")->envname("FARFIELD_CONNECT")->capture_default_str();
  app.add_flag("--tls", is_tls_, "Connect through TLS; the port is 7443 then unless --connect names one");
  app.add_option("--ca", ca_file_, "PEM file of the authorities believed about servers (default: the system's)")->envname("FARFIELD_CA");
  app.add_flag("--insecure-skip-verify", skips_verification_, "Believe any certificate: whoever is in between can read and change everything");
  app.add_option("--token-file", token_file_, "File with the access token (default: environment variable FARFIELD_TOKEN, else none)");
  app.add_flag("--allow-clear-token", allows_clear_token_, "Send the token without TLS to another machine too, where all in between can read it");
}

Result<ServerAccess> ServerArguments::access() const {
  const Result<ServerAddress> address = parse_server_address(connect_, is_tls_);
  if (!address) return fail_within("--connect", address.error());
  ServerAccess access{address->endpoint, nullptr, ""};
  if (!address->is_tls && (!ca_file_.empty() || skips_verification_)) {
    return fail(ErrorCode::kInvalidArgument, "{} means nothing without TLS: write --tls or farfields://",
                skips_verification_ ? "--insecure-skip-verify" : "--ca");
  }
  if (address->is_tls) {
    Result<std::shared_ptr<const TlsClient>> tls = TlsClient::make({access.endpoint.host, ca_file_, !skips_verification_});
    if (!tls) return fail_within("--ca", tls.error());
    access.tls = std::move(*tls);
  }
  const char* const variable = std::getenv(kTokenVariable);
  if (!token_file_.empty() || (variable && *variable)) {
    Result<std::string> token = token_file_.empty() ? checked_token(kTokenVariable, variable) : read_token(token_file_);
    if (!token) return tl::unexpected(token.error());
    access.token = std::move(*token);
  }
  if (!access.token.empty() && !access.tls && !is_loopback(access.endpoint) && !allows_clear_token_) {
    return fail(ErrorCode::kInvalidArgument,
                "the access token would travel to {} readable by all in between: use TLS (farfields://), or --allow-clear-token",
                to_string(access.endpoint));
  }
  return access;
}

}  // namespace farfield::client
