// SPDX-License-Identifier: Apache-2.0
// How much one client may ask for, whatever a client is: an address, or a token. Connections now, connections per time,
// views per time, and failed attempts to come in.
//
// An IPv6 client is its network of 64 bits, since whoever has one address there has them all.
// Bounded: whoever has no connection is forgotten when room is needed. Threads: any. The clock is handed in.
#pragma once

#include <asio/ip/address.hpp>
#include <array>
#include <chrono>
#include <map>
#include <memory>
#include <mutex>
#include <string>

#include "common/base/result.h"
#include "server/access/token_bucket.h"

namespace farfield {

using ClientKey = std::array<std::uint8_t, 32>;
ClientKey key_of(const asio::ip::address& address);

/// Rates hold on average; as much as the burst may come at once.
struct ClientPolicy {
  std::size_t connections = 400;           // at one time
  double connects_per_second = 50;
  double connect_burst = 400;
  double views_per_second = 400;           // cells entered, over all connections
  double failures_per_second = 0.1;        // attempts to come in with no valid token
  double failure_burst = 10;
  std::size_t remembered = 16'384;         // clients
};

/// What a client that asks for too much is told.
struct Refusal {
  std::string reason;
  std::chrono::milliseconds retry_after{0};
};

class ClientLimits : public std::enable_shared_from_this<ClientLimits> {
 public:
  using Clock = TokenBucket::Clock;

  /// One connection of a client, counted as long as this lives.
  class Visit {
   public:
    Visit(std::shared_ptr<ClientLimits> limits, const ClientKey& key) : limits_(std::move(limits)), key_(key) {}
    Visit(const Visit&) = delete;
    Visit& operator=(const Visit&) = delete;
    ~Visit() { limits_->leave(key_); }

    void note_failure(Clock::time_point now) { limits_->note_failure(key_, now); }
    /// Asks for one more view. Returns: zero if it may be had now, else the time to wait before asking again.
    Clock::duration view(Clock::time_point now) { return limits_->view(key_, now); }

   private:
    const std::shared_ptr<ClientLimits> limits_;
    const ClientKey key_;
  };

  /// `who`: as refusals call one, "address" or "token".
  static std::shared_ptr<ClientLimits> create(const ClientPolicy& policy, std::string who);

  tl::expected<std::shared_ptr<Visit>, Refusal> enter(const ClientKey& key, Clock::time_point now);
  std::size_t remembered() const;

 private:
  struct Client {
    explicit Client(const ClientPolicy& policy);
    std::size_t connections = 0;
    TokenBucket connects, views, failures;
  };
  ClientLimits(const ClientPolicy& policy, std::string who) : policy_(policy), who_(std::move(who)) {}
  void leave(const ClientKey& key);
  void note_failure(const ClientKey& key, Clock::time_point now);
  Clock::duration view(const ClientKey& key, Clock::time_point now);
  void make_room(Clock::time_point now);

  const ClientPolicy policy_;
  const std::string who_;
  mutable std::mutex mutex_;  // guards clients_
  std::map<ClientKey, Client> clients_;
};

}  // namespace farfield
