// SPDX-License-Identifier: Apache-2.0
#include "common/net/stream.h"

#include <asio/redirect_error.hpp>
#include <asio/ssl/stream.hpp>
#include <asio/steady_timer.hpp>
#include <asio/use_awaitable.hpp>
#include <utility>

namespace farfield {

using asio::ip::tcp;

Stream::Stream(tcp::socket socket) : plain_(std::move(socket)) {}
Stream::Stream(TlsSocketPointer socket) : plain_(socket->get_executor()), tls_(std::move(socket)) {}
Stream::~Stream() = default;

tcp::socket& Stream::socket() { return tls_ ? tls_->next_layer() : plain_; }

asio::awaitable<std::size_t> Stream::read_some(asio::mutable_buffer buffer, asio::error_code& error) {
  if (tls_) return tls_->async_read_some(buffer, asio::redirect_error(asio::use_awaitable, error));
  return plain_.async_read_some(buffer, asio::redirect_error(asio::use_awaitable, error));
}

asio::awaitable<std::size_t> Stream::write_some(const std::vector<asio::const_buffer>& buffers, asio::error_code& error) {
  if (tls_) return tls_->async_write_some(buffers, asio::redirect_error(asio::use_awaitable, error));
  return plain_.async_write_some(buffers, asio::redirect_error(asio::use_awaitable, error));
}

asio::awaitable<void> Stream::say_farewell(asio::error_code& error) {
  return tls_->async_shutdown(asio::redirect_error(asio::use_awaitable, error));
}

asio::awaitable<Status> shake_hands(std::shared_ptr<Stream> stream, bool is_server, std::chrono::milliseconds timeout) {
  if (!stream->is_tls()) co_return Status();
  asio::error_code error, ignored;
  const auto is_late = std::make_shared<bool>(false);
  asio::steady_timer deadline(stream->socket().get_executor(), timeout);
  deadline.async_wait([weak = std::weak_ptr(stream), is_late](const asio::error_code& cancelled) {
    const auto waiting = weak.lock();
    if (!waiting || cancelled) return;
    *is_late = true;
    asio::error_code unheard;
    waiting->socket().close(unheard);
  });
  const auto role = is_server ? asio::ssl::stream_base::server : asio::ssl::stream_base::client;
  co_await stream->tls_->async_handshake(role, asio::redirect_error(asio::use_awaitable, error));
  deadline.cancel();
  if (!error && !*is_late && stream->socket().is_open()) co_return Status();
  const std::string problem = is_server ? "" : certificate_problem(*stream->tls_);
  stream->socket().close(ignored);
  if (*is_late) co_return fail(ErrorCode::kUnavailable, "no TLS handshake within {} ms", timeout.count());
  if (!problem.empty()) co_return fail(ErrorCode::kUnauthenticated, "its certificate is not accepted: {}", problem);
  co_return fail(ErrorCode::kUnavailable, "no TLS handshake: {}", error.message());
}

}  // namespace farfield
