// SPDX-License-Identifier: Apache-2.0
// One tier before another: a fast one of this machine's own before a shared one.
//
//   find    front; else back, and what is found there is copied to the front
//   insert  both
#pragma once

#include <memory>

#include "server/store/blob_store.h"

namespace farfield {

class TieredBlobStore final : public BlobStore {
 public:
  /// Neither may be null.
  TieredBlobStore(std::shared_ptr<BlobStore> front, std::shared_ptr<BlobStore> back);

  SharedBytes find(const BlobKey& key) override;
  void insert(const BlobKey& key, SharedBytes bytes) override;
  Status flush() override;
  /// As one store: a miss is what neither had; the rest are sums.
  BlobStoreStatistics statistics() const override;
  std::vector<BlobStoreStatistics> tiers() const override;

 private:
  const std::shared_ptr<BlobStore> front_, back_;
};

}  // namespace farfield
