// SPDX-License-Identifier: Apache-2.0
#include "server/app/open_stores.h"

#include <utility>

#include "server/store/disk_store.h"
#include "server/store/redis_lease.h"
#include "server/store/redis_store.h"
#include "server/store/tiered_blob_store.h"

namespace farfield {

Result<OpenStores> open_stores(const StoreOptions& options, const std::function<void(const std::string&)>& log) {
  OpenStores stores;
  if (!options.folder.empty()) {
    auto disk = open_disk_store({.folder = options.folder, .capacity_bytes = options.folder_bytes - prepared_bytes(options), .log = log});
    if (!disk) return fail_within("--store", disk.error());
    stores.blobs = std::move(*disk);
  }
  if (!options.redis) return stores;
  const auto client = std::make_shared<RedisClient>(RedisClientOptions{.address = *options.redis, .log = log});
  const auto shared = std::make_shared<RedisStore>(client, RedisStoreOptions{.expiry = options.redis_expiry, .log = log});
  stores.lease = std::make_shared<RedisLease>(client, shared);
  if (stores.blobs) {
    stores.blobs = std::make_shared<TieredBlobStore>(std::move(stores.blobs), shared);
  } else {
    stores.blobs = shared;
  }
  return stores;
}

}  // namespace farfield
