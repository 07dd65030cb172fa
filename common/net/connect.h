// SPDX-License-Identifier: Apache-2.0
// Opening a connection, and listening for them.
#pragma once

#include <asio/any_io_executor.hpp>
#include <asio/awaitable.hpp>
#include <asio/ip/tcp.hpp>
#include <chrono>

#include "common/net/endpoint.h"

namespace farfield {

/// Resolves and connects, trying every address of the host. Errors: kNotFound (no such host), kUnavailable.
asio::awaitable<Result<asio::ip::tcp::socket>> connect_to(asio::any_io_executor executor, Endpoint endpoint,
                                                          std::chrono::milliseconds timeout);

/// A listening socket; port 0 takes any free one. Errors: kNotFound, kUnavailable (the port is in use), kIo.
Result<asio::ip::tcp::acceptor> listen_at(asio::any_io_executor executor, const Endpoint& endpoint);

}  // namespace farfield
