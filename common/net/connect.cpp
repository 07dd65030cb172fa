// SPDX-License-Identifier: Apache-2.0
#include "common/net/connect.h"

#include <asio/connect.hpp>
#include <asio/redirect_error.hpp>
#include <asio/steady_timer.hpp>
#include <asio/use_awaitable.hpp>
#include <memory>

namespace farfield {

asio::awaitable<Result<asio::ip::tcp::socket>> connect_to(asio::any_io_executor executor, Endpoint endpoint,
                                                          std::chrono::milliseconds timeout) {
  using asio::ip::tcp;
  asio::error_code error;
  tcp::resolver resolver(executor);
  const std::string service = std::to_string(endpoint.port);
  const tcp::resolver::results_type addresses =
      co_await resolver.async_resolve(endpoint.host, service, asio::redirect_error(asio::use_awaitable, error));
  if (error) {
    co_return fail(ErrorCode::kNotFound, "{}: no such host ({})", endpoint.host, error.message());
  }
  // The timer's handler may outlive this coroutine: it only touches what it shares.
  const auto socket = std::make_shared<tcp::socket>(executor);
  asio::steady_timer deadline(executor, timeout);
  deadline.async_wait([socket = std::weak_ptr(socket)](const asio::error_code& cancelled) {
    asio::error_code ignored;
    if (const auto waiting = socket.lock(); waiting && !cancelled) waiting->close(ignored);
  });
  co_await asio::async_connect(*socket, addresses, asio::redirect_error(asio::use_awaitable, error));
  deadline.cancel();
  if (error || !socket->is_open()) {
    const std::string why = socket->is_open() && error != asio::error::operation_aborted
                                ? error.message()
                                : fmt::format("no answer within {} ms", timeout.count());
    co_return fail(ErrorCode::kUnavailable, "cannot connect to {}: {}; is a farfield-server running there?",
                   to_string(endpoint), why);
  }
  tcp::socket connected = std::move(*socket);
  co_return Result<tcp::socket>(std::move(connected));
}

Result<asio::ip::tcp::acceptor> listen_at(asio::any_io_executor executor, const Endpoint& endpoint) {
  using asio::ip::tcp;
  asio::error_code error;
  tcp::resolver resolver(executor);
  const auto addresses =
      resolver.resolve(endpoint.host, std::to_string(endpoint.port), tcp::resolver::passive, error);
  if (error || addresses.empty()) {
    return fail(ErrorCode::kNotFound, "{}: no such address to listen at ({})", endpoint.host, error.message());
  }
  const tcp::endpoint address = addresses.begin()->endpoint();
  tcp::acceptor acceptor(executor);
  acceptor.open(address.protocol(), error);
  if (!error) acceptor.set_option(tcp::acceptor::reuse_address(true), error);
  if (!error) acceptor.bind(address, error);
  if (!error) acceptor.listen(asio::socket_base::max_listen_connections, error);
  if (error == asio::error::address_in_use) {
    return fail(ErrorCode::kUnavailable, "{} is in use by another program: choose another port with --listen, or 0 for any",
                to_string(endpoint));
  }
  if (error) return fail(ErrorCode::kIo, "cannot listen at {}: {}", to_string(endpoint), error.message());
  return acceptor;
}

}  // namespace farfield
