// SPDX-License-Identifier: Apache-2.0
#include "server/access/client_limits.h"

#include <algorithm>

namespace farfield {
namespace {

constexpr std::chrono::milliseconds kUntilSomeoneLeaves{5000};

/// Rounded up, so that whoever comes back then is not too early.
std::chrono::milliseconds to_wait(ClientLimits::Clock::duration wait) { return std::chrono::ceil<std::chrono::milliseconds>(wait); }

}  // namespace

ClientKey key_of(const asio::ip::address& address) {
  ClientKey key{};
  if (address.is_v6() && !address.to_v6().is_v4_mapped()) {
    const auto bytes = address.to_v6().to_bytes();
    key[0] = 6;
    std::copy_n(bytes.begin(), 8, key.begin() + 1);
    return key;
  }
  const asio::ip::address_v4 v4 = address.is_v4() ? address.to_v4() : asio::ip::make_address_v4(asio::ip::v4_mapped, address.to_v6());
  const auto bytes = v4.to_bytes();
  key[0] = 4;
  std::copy(bytes.begin(), bytes.end(), key.begin() + 1);
  return key;
}

ClientLimits::Client::Client(const ClientPolicy& policy)
    : connects(policy.connects_per_second, policy.connect_burst),
      views(policy.views_per_second, 2 * policy.views_per_second),
      failures(policy.failures_per_second, policy.failure_burst) {}

std::shared_ptr<ClientLimits> ClientLimits::create(const ClientPolicy& policy, std::string who) {
  return std::shared_ptr<ClientLimits>(new ClientLimits(policy, std::move(who)));
}

tl::expected<std::shared_ptr<ClientLimits::Visit>, Refusal> ClientLimits::enter(const ClientKey& key, Clock::time_point now) {
  const std::lock_guard lock(mutex_);
  if (!clients_.contains(key) && clients_.size() >= policy_.remembered) make_room(now);
  Client& client = clients_.try_emplace(key, policy_).first->second;
  if (!client.failures.has(now)) {
    return tl::unexpected(Refusal{fmt::format("too many attempts without a valid token from this {}", who_), to_wait(client.failures.wait(now))});
  }
  if (client.connections >= policy_.connections) {
    return tl::unexpected(Refusal{fmt::format("this {} has {} connections already", who_, client.connections), kUntilSomeoneLeaves});
  }
  if (!client.connects.take(now)) {
    return tl::unexpected(Refusal{fmt::format("this {} connects too often", who_), to_wait(client.connects.wait(now))});
  }
  ++client.connections;
  return std::make_shared<Visit>(shared_from_this(), key);
}

void ClientLimits::leave(const ClientKey& key) {
  const std::lock_guard lock(mutex_);
  const auto client = clients_.find(key);
  if (client != clients_.end() && client->second.connections > 0) --client->second.connections;
}

void ClientLimits::note_failure(const ClientKey& key, Clock::time_point now) {
  const std::lock_guard lock(mutex_);
  if (const auto client = clients_.find(key); client != clients_.end()) client->second.failures.take(now);
}

ClientLimits::Clock::duration ClientLimits::view(const ClientKey& key, Clock::time_point now) {
  const std::lock_guard lock(mutex_);
  const auto client = clients_.find(key);
  if (client == clients_.end() || client->second.views.take(now)) return Clock::duration::zero();
  return client->second.views.wait(now);
}

// Those who have used nothing up first; if all have, they are given a new start rather than everybody else none.
void ClientLimits::make_room(Clock::time_point now) {
  for (auto at = clients_.begin(); at != clients_.end();) {
    Client& client = at->second;
    const bool is_new_again = client.connections == 0 && client.connects.is_full(now) && client.failures.is_full(now);
    at = is_new_again ? clients_.erase(at) : std::next(at);
  }
  if (clients_.size() < policy_.remembered) return;
  std::erase_if(clients_, [](const auto& entry) { return entry.second.connections == 0; });
}

std::size_t ClientLimits::remembered() const {
  const std::lock_guard lock(mutex_);
  return clients_.size();
}

}  // namespace farfield
