// SPDX-License-Identifier: Apache-2.0
// Bytes both ways over one TCP connection, plain or inside TLS, behind one face.
//
// On the plain path gathered buffers go to the kernel as they are; TLS encrypts them into a buffer of its own, which is the one copy
// that it cannot avoid. One read and one write may wait at a time.
// Threads: the executor of the socket, a strand or an io_context run by one thread.
#pragma once

#include <asio/awaitable.hpp>
#include <asio/buffer.hpp>
#include <asio/ip/tcp.hpp>
#include <chrono>
#include <memory>
#include <vector>

#include "common/net/tls.h"

namespace farfield {

class Stream {
 public:
  explicit Stream(asio::ip::tcp::socket socket);
  /// Carries nothing before shake_hands() has succeeded.
  explicit Stream(TlsSocketPointer socket);
  ~Stream();

  bool is_tls() const { return tls_ != nullptr; }
  /// For options, addresses and closing; not for bytes.
  asio::ip::tcp::socket& socket();
  const asio::ip::tcp::socket& socket() const { return const_cast<Stream*>(this)->socket(); }

  /// Returns: how many bytes, at least one unless `error` is set. `error` must outlive the wait.
  asio::awaitable<std::size_t> read_some(asio::mutable_buffer buffer, asio::error_code& error);
  asio::awaitable<std::size_t> write_some(const std::vector<asio::const_buffer>& buffers, asio::error_code& error);
  /// TLS's own farewell, so that the end cannot be mistaken for a cut; waits for the peer's. Requires: is_tls(), no write waits.
  asio::awaitable<void> say_farewell(asio::error_code& error);

 private:
  friend asio::awaitable<Status> shake_hands(std::shared_ptr<Stream> stream, bool is_server, std::chrono::milliseconds timeout);
  asio::ip::tcp::socket plain_;
  TlsSocketPointer tls_;  // null: plain
};

/// TLS's handshake; nothing to do on a plain stream. Afterwards the stream is closed unless it succeeded.
/// Errors: kUnauthenticated (the server's certificate is not accepted: trying again is no use), kUnavailable (cut, too slow, or no TLS).
asio::awaitable<Status> shake_hands(std::shared_ptr<Stream> stream, bool is_server, std::chrono::milliseconds timeout);

}  // namespace farfield
