// SPDX-License-Identifier: Apache-2.0
// Tells whoever started the server how it is: systemd's notification protocol, one datagram per message (man 3 sd_notify).
//
// Three lines of text to a socket named in the environment: not worth a library.
#pragma once

#include <chrono>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <thread>

namespace farfield {

/// Says nothing, and costs nothing, where nobody asked: NOTIFY_SOCKET is not set.
class Supervisor {
 public:
  /// From NOTIFY_SOCKET and, for this process, WATCHDOG_USEC.
  static Supervisor from_environment();
  Supervisor(std::string socket, std::optional<std::chrono::microseconds> watchdog) : socket_(std::move(socket)), watchdog_(watchdog) {}

  bool is_there() const { return !socket_.empty(); }
  void ready(std::string_view status) const;
  void stopping() const;
  /// Pings at half the time after which the watchdog would bite, for as long as `is_alive` says so; it may take its time, and no ping is
  /// sent meanwhile. Returns: a thread to keep while it is to go on; null if no watchdog waits.
  std::optional<std::jthread> keep_pinging(std::function<bool()> is_alive) const;

 private:
  void send(const std::string& message) const;

  std::string socket_;
  std::optional<std::chrono::microseconds> watchdog_;
};

}  // namespace farfield
