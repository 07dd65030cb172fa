// SPDX-License-Identifier: Apache-2.0
// The tier that several servers share: tiles, plans and names of leaves in Redis, which forgets what it has no room for.
//
//   ff:t:KEY, ff:p:KEY, ff:n:KEY   a tile, a plan, a leaf's name under the 26 bytes of its BlobKey
//                                  value: the bytes, then u64 XXH3 of bytes and key, little-endian
//   ff:l:KEY                       a lease (redis_lease.h)
//
// Whoever finds must be able to wait a command's time limit (RedisClientOptions), once per loss of the server. A thread writes what was
// inserted, in batches; while Redis is gone what is inserted waits, up to a bound.
#pragma once

#include <deque>
#include <unordered_map>

#include "server/store/blob_store.h"
#include "server/store/redis_client.h"

namespace farfield {

struct RedisStoreOptions {
  std::chrono::seconds expiry{7 * 24 * 3600};            // of what is written, counted from then
  std::size_t waiting_bytes = std::size_t{64} << 20;     // more are dropped: Redis is gone, or too slow for what is made
  std::function<void(const std::string&)> log;           // refused writes, one line each, at most one a minute; may be empty
};

/// Of a blob in Redis; of a lease with `letter` 'l'.
std::string redis_key(const BlobKey& key);
std::string redis_key(const BlobKey& key, char letter);

class RedisStore final : public BlobStore {
 public:
  RedisStore(std::shared_ptr<RedisClient> client, RedisStoreOptions options);
  /// Writes what waits, if Redis is there.
  ~RedisStore() override;

  SharedBytes find(const BlobKey& key) override;
  void insert(const BlobKey& key, SharedBytes bytes) override;
  /// Errors: kIo: something could not be written since the last flush, or Redis is gone and what waits stays waiting.
  Status flush() override;
  BlobStoreStatistics statistics() const override;

  /// Runs a command after everything inserted before has been written or lost. Dropped while Redis is gone.
  void run_after_inserts(std::vector<std::string> command);

 private:
  // One thing to write, in the order in which they came.
  struct Step {
    BlobKey key;
    SharedBytes bytes;                 // null with no command: the blob is damaged, remove it
    std::vector<std::string> command;  // not empty: in place of a blob
    bool was_tried = false;
  };

  void write(const std::stop_token& stop);
  // Requires: mutex_ held.
  std::vector<Step> take_batch();
  void forget_waiting(const Step& step);
  bool send(const std::vector<Step>& batch);
  void complain(const std::string& what);

  const std::shared_ptr<RedisClient> client_;
  const RedisStoreOptions options_;

  mutable std::mutex mutex_;  // guards everything below
  std::condition_variable_any changed_, written_;
  std::deque<Step> steps_;
  std::unordered_map<BlobKey, SharedBytes> waiting_;  // inserted and not yet written
  std::size_t waiting_bytes_ = 0;
  bool is_writing_ = false, has_lost_ = false;
  BlobStoreStatistics statistics_;
  std::chrono::steady_clock::time_point next_complaint_;
  std::jthread writer_thread_;
};

}  // namespace farfield
