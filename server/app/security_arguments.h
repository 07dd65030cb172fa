// SPDX-License-Identifier: Apache-2.0
// The options of farfield-server that say who may come in, and how.
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>

#include "common/net/endpoint.h"
#include "common/net/tls.h"
#include "server/access/client_limits.h"

namespace farfield {

struct SecurityOptions {
  std::optional<Endpoint> tls_listen;
  TlsFiles tls;
  std::filesystem::path tokens;  // empty: everybody may come in
  ClientPolicy per_address;
};

class SecurityArguments {
 public:
  void add_to(CLI::App& app);
  /// After parsing. Errors: kInvalidArgument; the message names the option.
  Result<SecurityOptions> options() const;

 private:
  std::string tls_listen_, certificate_, key_, tokens_;
  ClientPolicy per_address_;
};

}  // namespace farfield
