// SPDX-License-Identifier: Apache-2.0
#include "common/net/tls.h"

#include <openssl/ssl.h>
#include <openssl/x509v3.h>

#include <asio/ip/address.hpp>
#include <asio/ssl/context.hpp>
#include <asio/ssl/stream.hpp>
#include <utility>

namespace farfield {
namespace {

// TLS 1.2: ephemeral keys and authenticated encryption only. TLS 1.3 has nothing else.
constexpr const char* kTls12Ciphers = "ECDHE+AESGCM:ECDHE+CHACHA20";

std::string reason_of(const asio::error_code& error) { return error.message(); }

Status set_policy(asio::ssl::context& context) {
  SSL_CTX* const raw = context.native_handle();
  SSL_CTX_set_options(raw, SSL_OP_NO_COMPRESSION | SSL_OP_NO_RENEGOTIATION | SSL_OP_CIPHER_SERVER_PREFERENCE);
  // Buffers of idle connections are given back: 34 kB for each viewer who stands still.
  SSL_CTX_set_mode(raw, SSL_MODE_RELEASE_BUFFERS);
  if (SSL_CTX_set_min_proto_version(raw, TLS1_2_VERSION) != 1 || SSL_CTX_set_cipher_list(raw, kTls12Ciphers) != 1) {
    return fail(ErrorCode::kInternal, "this OpenSSL has no TLS 1.2 with authenticated ciphers");
  }
  return {};
}

Status check_exists(const char* what, const std::filesystem::path& file) {
  std::error_code ignored;
  if (std::filesystem::is_regular_file(file, ignored)) return {};
  return fail(ErrorCode::kNotFound, "{}: no such file: {}", what, file.string());
}

Result<std::shared_ptr<asio::ssl::context>> read_context(const TlsFiles& files) {
  if (Status status = check_exists("the certificate", files.certificate); !status) return tl::unexpected(status.error());
  if (Status status = check_exists("the key", files.key); !status) return tl::unexpected(status.error());
  auto context = std::make_shared<asio::ssl::context>(asio::ssl::context::tls_server);
  if (Status status = set_policy(*context); !status) return tl::unexpected(status.error());
  // A key under a passphrase must fail, and not ask on the terminal.
  asio::error_code error;
  context->set_password_callback([](std::size_t, asio::ssl::context::password_purpose) { return std::string(); }, error);
  context->use_certificate_chain_file(files.certificate.string(), error);
  if (error) {
    return fail(ErrorCode::kBadData, "{} holds no PEM certificate ({})", files.certificate.string(), reason_of(error));
  }
  context->use_private_key_file(files.key.string(), asio::ssl::context::pem, error);
  if (error || SSL_CTX_check_private_key(context->native_handle()) != 1) {
    return fail(ErrorCode::kBadData, "{} holds no PEM key without passphrase that belongs to the certificate ({})", files.key.string(),
                error ? reason_of(error) : "they do not match");
  }
  return context;
}

bool is_address(const std::string& host) {
  asio::error_code error;
  asio::ip::make_address(host, error);
  return !error;
}

}  // namespace

void TlsSocketDeleter::operator()(TlsSocket* socket) const { delete socket; }

TlsServer::TlsServer(TlsFiles files) : files_(std::move(files)) {}
TlsServer::~TlsServer() = default;

Result<std::shared_ptr<TlsServer>> TlsServer::load(TlsFiles files) {
  std::shared_ptr<TlsServer> server(new TlsServer(std::move(files)));
  if (Status status = server->reload(); !status) return tl::unexpected(status.error());
  return server;
}

Status TlsServer::reload() {
  Result<std::shared_ptr<asio::ssl::context>> context = read_context(files_);
  if (!context) return tl::unexpected(context.error());
  const std::lock_guard lock(mutex_);
  context_ = std::move(*context);
  return {};
}

TlsSocketPointer TlsServer::wrap(asio::ip::tcp::socket socket) const {
  const std::lock_guard lock(mutex_);
  return TlsSocketPointer(new TlsSocket(std::move(socket), *context_));
}

TlsClient::TlsClient(TlsTrust trust) : trust_(std::move(trust)) {}
TlsClient::~TlsClient() = default;

Result<std::shared_ptr<const TlsClient>> TlsClient::make(TlsTrust trust) {
  std::shared_ptr<TlsClient> client(new TlsClient(std::move(trust)));
  client->context_ = std::make_unique<asio::ssl::context>(asio::ssl::context::tls_client);
  asio::ssl::context& context = *client->context_;
  if (Status status = set_policy(context); !status) return tl::unexpected(status.error());
  asio::error_code error;
  const std::filesystem::path& ca_file = client->trust_.ca_file;
  if (!ca_file.empty()) {
    if (Status status = check_exists("the authorities' certificates", ca_file); !status) return tl::unexpected(status.error());
    context.load_verify_file(ca_file.string(), error);
    if (error) return fail(ErrorCode::kBadData, "{} holds no PEM certificate ({})", ca_file.string(), reason_of(error));
  } else {
    context.set_default_verify_paths(error);
  }
  context.set_verify_mode(client->trust_.is_verified ? asio::ssl::verify_peer : asio::ssl::verify_none, error);
  return std::shared_ptr<const TlsClient>(std::move(client));
}

Result<TlsSocketPointer> TlsClient::wrap(asio::ip::tcp::socket socket) const {
  TlsSocketPointer secure(new TlsSocket(std::move(socket), *context_));
  SSL* const raw = secure->native_handle();
  X509_VERIFY_PARAM* const wanted = SSL_get0_param(raw);
  X509_VERIFY_PARAM_set_hostflags(wanted, X509_CHECK_FLAG_NO_PARTIAL_WILDCARDS);
  // Addresses stand in certificates as addresses, and are not announced to the server as a name.
  const bool is_set = is_address(trust_.host)
                          ? X509_VERIFY_PARAM_set1_ip_asc(wanted, trust_.host.c_str()) == 1
                          : X509_VERIFY_PARAM_set1_host(wanted, trust_.host.data(), trust_.host.size()) == 1 &&
                                SSL_set_tlsext_host_name(raw, trust_.host.c_str()) == 1;
  if (!is_set || trust_.host.empty()) return fail(ErrorCode::kInvalidArgument, "'{}' is no name of a host that a certificate could be for", trust_.host);
  return secure;
}

std::string certificate_problem(TlsSocket& socket) {
  const long result = SSL_get_verify_result(socket.native_handle());
  return result == X509_V_OK ? "" : X509_verify_cert_error_string(result);
}

}  // namespace farfield
