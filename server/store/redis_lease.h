// SPDX-License-Identifier: Apache-2.0
// Leases kept in Redis, beside the values they are for: ff:l:KEY holds who makes it, and expires unless it is renewed.
//
// A server that was killed holds others up for `duration`; one that was only slow loses its turn, and the same is made twice.
#pragma once

#include <condition_variable>
#include <mutex>
#include <thread>
#include <unordered_map>

#include "server/store/generation_lease.h"
#include "server/store/redis_store.h"

namespace farfield {

class RedisLease final : public GenerationLease {
 public:
  static constexpr std::chrono::milliseconds kDuration{3000};

  /// `store`: that of the values, whose writes releases wait for; neither may be null. `duration` above zero; renewed after each third of it.
  RedisLease(std::shared_ptr<RedisClient> client, std::shared_ptr<RedisStore> store, std::chrono::milliseconds duration = kDuration);
  ~RedisLease() override;

  Turn acquire(const BlobKey& key) override;
  void release(const BlobKey& key) override;
  std::vector<bool> are_held(std::span<const BlobKey> keys) override;

 private:
  void renew(const std::stop_token& stop);

  const std::shared_ptr<RedisClient> client_;
  const std::shared_ptr<RedisStore> store_;
  const std::chrono::milliseconds duration_;
  const std::string process_;  // that no other has

  std::mutex mutex_;  // guards the next three
  std::condition_variable_any changed_;
  std::uint64_t acquired_ = 0;
  std::unordered_map<BlobKey, std::string> held_;  // and as whom: each turn has an owner of its own
  std::jthread renewer_;
};

}  // namespace farfield
