// SPDX-License-Identifier: Apache-2.0
// The options of every client program that say which server, how securely, and who is asking.
#pragma once

#include <CLI/CLI.hpp>
#include <memory>
#include <string>

#include "common/net/endpoint.h"
#include "common/net/tls.h"

namespace farfield::client {

struct ServerAccess {
  Endpoint endpoint;
  std::shared_ptr<const TlsClient> tls;  // null: a plain connection
  std::string token;                     // empty: none
};

class ServerArguments {
 public:
  void add_to(CLI::App& app);
  /// After parsing. The token comes from --token-file or the environment, never from the command line, which every user
  /// of the machine can read. Errors: kInvalidArgument, kNotFound, kBadData; the message names the option.
  Result<ServerAccess> access() const;

 private:
  std::string connect_ = "127.0.0.1:7400", ca_file_, token_file_;
  bool is_tls_ = false, skips_verification_ = false, allows_clear_token_ = false;
};

}  // namespace farfield::client
