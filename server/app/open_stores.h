// SPDX-License-Identifier: Apache-2.0
// The tiers behind memory, as the command line names them: a folder, a Redis server, one behind the other, or none.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "server/store/blob_store.h"
#include "server/store/generation_lease.h"
#include "server/store/redis_connection.h"

namespace farfield {

struct StoreOptions {
  std::filesystem::path folder;                     // of what outlives the process; empty: none
  std::size_t folder_bytes = std::size_t{16} << 30;
  std::optional<RedisAddress> redis;                // shared with other servers
  std::chrono::seconds redis_expiry{7 * 24 * 3600};
};

/// A quarter of the folder is for prepared scenes, unless it is too small to hold any; the rest for cells.
inline std::size_t prepared_bytes(const StoreOptions& options) {
  constexpr std::size_t kLeastFolder = std::size_t{16} << 20;
  return options.folder.empty() || options.folder_bytes < kLeastFolder ? 0 : options.folder_bytes / 4;
}

struct OpenStores {
  std::shared_ptr<BlobStore> blobs;        // null: no tier is wanted
  std::shared_ptr<GenerationLease> lease;  // null: nobody shares them
};

/// A Redis server that is not there is said in the log, and joined when it is. Errors: the folder's, as open_disk_store().
Result<OpenStores> open_stores(const StoreOptions& options, const std::function<void(const std::string&)>& log);

}  // namespace farfield
