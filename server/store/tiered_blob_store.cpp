// SPDX-License-Identifier: Apache-2.0
#include "server/store/tiered_blob_store.h"

#include <utility>

namespace farfield {

TieredBlobStore::TieredBlobStore(std::shared_ptr<BlobStore> front, std::shared_ptr<BlobStore> back) : front_(std::move(front)), back_(std::move(back)) {}

SharedBytes TieredBlobStore::find(const BlobKey& key) {
  if (SharedBytes found = front_->find(key)) return found;
  SharedBytes found = back_->find(key);
  if (found) front_->insert(key, found);
  return found;
}

void TieredBlobStore::insert(const BlobKey& key, SharedBytes bytes) {
  front_->insert(key, bytes);
  back_->insert(key, std::move(bytes));
}

Status TieredBlobStore::flush() {
  const Status front = front_->flush(), back = back_->flush();
  return front ? back : front;
}

BlobStoreStatistics TieredBlobStore::statistics() const {
  const BlobStoreStatistics front = front_->statistics(), back = back_->statistics();
  BlobStoreStatistics sum = front;
  sum.tier = "all";
  sum.is_reachable = front.is_reachable || back.is_reachable;
  sum.hits += back.hits, sum.misses = back.misses, sum.damaged += back.damaged;
  sum.inserts += back.inserts, sum.dropped += back.dropped, sum.rewritten += back.rewritten, sum.evictions += back.evictions;
  sum.items += back.items, sum.bytes += back.bytes;
  return sum;
}

std::vector<BlobStoreStatistics> TieredBlobStore::tiers() const {
  std::vector<BlobStoreStatistics> all = front_->tiers();
  for (const BlobStoreStatistics& tier : back_->tiers()) all.push_back(tier);
  return all;
}

}  // namespace farfield
