// SPDX-License-Identifier: Apache-2.0
// The options of every program that fills or reads stores: where they are, and how much they may take.
#pragma once

#include <string>

#include "common/base/byte_size.h"
#include "common/base/command_line.h"
#include "common/base/duration.h"
#include "server/app/open_stores.h"

namespace farfield {

/// Must outlive the parsing of the command it was added to.
class StoreArguments {
 public:
  void add_to(CLI::App& app) {
    app.add_option("--store", options_.folder, "Folder where tiles, plans and prepared scenes are kept for the next start (default: none)");
    app.add_option("--store-bytes", folder_bytes_, "Bound of that folder's contents; least recently used go first")->capture_default_str();
    app.add_option("--redis", redis_, "Redis server that several servers share tiles and plans through, HOST:PORT or unix:PATH (default: none)");
    app.add_option("--redis-expiry", redis_expiry_, "How long it keeps them, as 12h or 7d")->capture_default_str();
  }
  /// After parsing. Errors: kInvalidArgument.
  Result<StoreOptions> options() const {
    StoreOptions result = options_;
    const Result<std::size_t> folder_bytes = parse_byte_size(folder_bytes_);
    if (!folder_bytes) return fail_within("--store-bytes", folder_bytes.error());
    result.folder_bytes = *folder_bytes;
    if (!redis_.empty()) {
      Result<RedisAddress> redis = parse_redis_address(redis_);
      if (!redis) return fail_within("--redis", redis.error());
      result.redis = std::move(*redis);
    }
    const Result<std::chrono::seconds> expiry = parse_duration(redis_expiry_);
    if (!expiry) return fail_within("--redis-expiry", expiry.error());
    result.redis_expiry = *expiry;
    return result;
  }

 private:
  StoreOptions options_;
  std::string folder_bytes_ = "16GiB", redis_, redis_expiry_ = "7d";
};

}  // namespace farfield
