// SPDX-License-Identifier: Apache-2.0
// Everything a client can make the server spend, bounded in one place. What clients must know travels in Welcome.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>

#include "server/access/client_limits.h"

namespace farfield {

struct ServerLimits {
  std::size_t sessions = 1000;
  std::size_t handshakes = 256;          // of TLS, under way at one time; beyond it connections are closed unheard
  // ── per client, over all its sessions ──
  ClientPolicy per_address;
  ClientPolicy per_token{.connections = 250, .connects_per_second = 20, .connect_burst = 250, .views_per_second = 200};
  /// Loopback is no one client: a proxy on this machine stands for all of its own, and everybody here is trusted more.
  bool limits_loopback = false;
  // ── announced ──
  std::uint32_t held = 65536;            // hashes in Hello.held and Evicted: half the largest message
  std::uint32_t poses_per_second = 30;   // a walker moves 5 cm between two of them
  std::uint32_t leaves_per_second = 20;
  // ── per session ──
  std::size_t outbox_bytes = std::size_t{128} << 10;   // payloads waiting: what the viewer walks away from is taken back, and was work
  std::size_t control_pause_bytes = std::size_t{512} << 10;  // control frames waiting beyond which no leaf set is announced
  std::size_t control_bytes = std::size_t{4} << 20;    // a peer that lets more than this wait is not reading
  std::size_t held_remembered = std::size_t{1} << 18;  // beyond it the oldest are forgotten, and would be sent again
  /// Payloads asked of the cell service and not yet sent. Enough to keep a dozen threads busy; all of them are in the
  /// queue before whatever the viewer needs next, so more only makes a change of plan slower.
  std::size_t requests = 24;
  std::size_t prefetch_requests = 8;     // of these, for leaves the viewer is not in
  std::size_t prefetched_leaves = 2;     // leaf sets sent ahead at one time
  // ── time ──
  std::chrono::milliseconds handshake_timeout{5'000};  // of TLS
  std::chrono::milliseconds hello_timeout{10'000};
  std::chrono::milliseconds ping_after{10'000};        // silence
  std::chrono::milliseconds give_up_after{30'000};     // silence after pings, or a write without progress
  std::chrono::milliseconds resume_for{60'000};
  std::size_t resumable = 4096;
};

}  // namespace farfield
