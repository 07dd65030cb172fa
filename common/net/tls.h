// SPDX-License-Identifier: Apache-2.0
// What a side needs to speak TLS: the server's certificate and key, the client's idea of whom to trust.
//
// TLS 1.2 with forward secrecy and authenticated ciphers at least, 1.3 where both can. A client verifies the chain and the name, always,
// unless the user has said in so many words that it shall not.
// Threads: TlsServer from any; TlsClient is immutable.
#pragma once

#include <asio/ip/tcp.hpp>
#include <filesystem>
#include <memory>
#include <mutex>
#include <string>

#include "common/base/result.h"

namespace asio::ssl {
class context;
template <typename Socket>
class stream;
}  // namespace asio::ssl

namespace farfield {

using TlsSocket = asio::ssl::stream<asio::ip::tcp::socket>;
/// So that only what speaks TLS has to include it.
struct TlsSocketDeleter {
  void operator()(TlsSocket* socket) const;
};
using TlsSocketPointer = std::unique_ptr<TlsSocket, TlsSocketDeleter>;

struct TlsFiles {
  std::filesystem::path certificate;  // PEM: the server's own first, then those that lead to the root
  std::filesystem::path key;          // PEM, without a passphrase
};

class TlsServer {
 public:
  /// Errors: kNotFound, kBadData (no certificate, no key, or they do not belong together).
  static Result<std::shared_ptr<TlsServer>> load(TlsFiles files);
  ~TlsServer();

  /// Reads the files again, for connections from now on; those that exist keep what they began with.
  /// Errors: as load(); what was there before stays in use.
  Status reload();
  TlsSocketPointer wrap(asio::ip::tcp::socket socket) const;

 private:
  explicit TlsServer(TlsFiles files);
  const TlsFiles files_;
  mutable std::mutex mutex_;  // guards context_
  std::shared_ptr<asio::ssl::context> context_;
};

struct TlsTrust {
  std::string host;               // the name or address that the certificate must be for
  std::filesystem::path ca_file;  // PEM; empty: the authorities that this system trusts
  bool is_verified = true;        // false: anyone is believed, which protects against listeners only
};

class TlsClient {
 public:
  /// Errors: kNotFound, kBadData (a file without certificates).
  static Result<std::shared_ptr<const TlsClient>> make(TlsTrust trust);
  ~TlsClient();

  /// Errors: kInvalidArgument (a host that can be no name in a certificate).
  Result<TlsSocketPointer> wrap(asio::ip::tcp::socket socket) const;
  const std::string& host() const { return trust_.host; }

 private:
  explicit TlsClient(TlsTrust trust);
  const TlsTrust trust_;
  std::unique_ptr<asio::ssl::context> context_;
};

/// Why a certificate was not accepted, in OpenSSL's words; empty if that was not what failed.
std::string certificate_problem(TlsSocket& socket);

}  // namespace farfield
