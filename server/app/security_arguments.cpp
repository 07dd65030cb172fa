// SPDX-License-Identifier: Apache-2.0
#include "server/app/security_arguments.h"

#include "common/base/command_line.h"

namespace farfield {

void SecurityArguments::add_to(CLI::App& app) {
  app.add_option("--tls-listen", tls_listen_, "HOST:PORT for clients through TLS; the default port is 7443. Without --listen nothing else is listened at");
  app.add_option("--tls-cert", certificate_, "PEM file: the certificate, then those that lead to its root; read again on SIGHUP");
  app.add_option("--tls-key", key_, "PEM file of its key");
  app.add_option("--tokens", tokens_, "List of the access tokens that are good, made by farfield-token; read again on SIGHUP (default: everybody may come in)");
  app.add_option("--connections-per-address", per_address_.connections, "At one time; an IPv6 network of 64 bits is one address, this machine's own have no limit")
      ->check(whole_number_between(1, 1'000'000))
      ->capture_default_str();
  app.add_option("--connects-per-address", per_address_.connects_per_second, "New connections each second, on average")
      ->check(number_between(0.01, 1e6))
      ->capture_default_str();
}

Result<SecurityOptions> SecurityArguments::options() const {
  SecurityOptions options;
  options.tokens = tokens_;
  options.per_address = per_address_;
  if (tls_listen_.empty() && certificate_.empty() && key_.empty()) return options;
  if (tls_listen_.empty() || certificate_.empty() || key_.empty()) {
    return fail(ErrorCode::kInvalidArgument, "--tls-listen, --tls-cert and --tls-key belong together: one is missing");
  }
  const Result<Endpoint> listen = parse_endpoint(tls_listen_, kDefaultTlsPort);
  if (!listen) return fail_within("--tls-listen", listen.error());
  options.tls_listen = *listen;
  options.tls = TlsFiles{certificate_, key_};
  return options;
}

}  // namespace farfield
