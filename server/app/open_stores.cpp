// SPDX-License-Identifier: Apache-2.0
#include "server/app/open_stores.h"

#include <utility>

#include "server/store/disk_store.h"
#include "server/store/redis_store.h"
#include "server/store/tiered_blob_store.h"

namespace farfield {

Result<std::shared_ptr<BlobStore>> open_stores(const StoreOptions& options, const std::function<void(const std::string&)>& log) {
  std::shared_ptr<BlobStore> disk, shared;
  if (!options.folder.empty()) {
    auto opened = open_disk_store({.folder = options.folder, .capacity_bytes = options.folder_bytes, .log = log});
    if (!opened) return fail_within("--store", opened.error());
    disk = std::move(*opened);
  }
  if (options.redis) {
    auto client = std::make_shared<RedisClient>(RedisClientOptions{.address = *options.redis, .log = log});
    shared = std::make_shared<RedisStore>(std::move(client), RedisStoreOptions{.expiry = options.redis_expiry, .log = log});
  }
  if (disk && shared) return std::make_shared<TieredBlobStore>(std::move(disk), std::move(shared));
  return disk ? disk : shared;
}

}  // namespace farfield
