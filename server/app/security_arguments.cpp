// SPDX-License-Identifier: Apache-2.0
#include "server/app/security_arguments.h"

namespace farfield {

void SecurityArguments::add_to(CLI::App& app) {
  app.add_option("--tls-listen", tls_listen_, "HOST:PORT for clients through TLS; the default port is 7443. Without --listen nothing else is listened at");
  app.add_option("--tls-cert", certificate_, "PEM file: the certificate, then those that lead to its root; read again on SIGHUP");
  app.add_option("--tls-key", key_, "PEM file of its key");
}

Result<SecurityOptions> SecurityArguments::options() const {
  SecurityOptions options;
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
