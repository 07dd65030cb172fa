// SPDX-License-Identifier: Apache-2.0
// Whose turn it is to make something, among servers that share a store: what single flight is within one.
//
//   acquire ─▶ ours    make it, insert it, release
//              theirs  another server makes it: wait until the lease is gone, then look in the store
//              made    it is in the store by now
//              alone   nobody can tell: make it
//
// A lease ends by itself soon after its holder died. That it is held only saves work: whoever cannot or will not wait makes the same bytes.
#pragma once

#include <span>
#include <vector>

#include "server/store/blob_store.h"

namespace farfield {

enum class Turn { kOurs, kTheirs, kMade, kAlone };

/// Thread-safe.
class GenerationLease {
 public:
  virtual ~GenerationLease() = default;
  /// May wait for a network as long as BlobStore::find(). Ours until release(), however long that takes.
  virtual Turn acquire(const BlobKey& key) = 0;
  /// Returns at once; takes effect after everything inserted into the shared store before has been written.
  virtual void release(const BlobKey& key) = 0;
  /// Which of them anybody holds now; none if nobody can tell.
  virtual std::vector<bool> are_held(std::span<const BlobKey> keys) = 0;
};

/// A turn and, if it is ours, the lease behind it: released with this object.
class HeldTurn {
 public:
  HeldTurn(GenerationLease& lease, const BlobKey& key) : lease_(&lease), key_(key), turn_(lease.acquire(key)) {}
  explicit HeldTurn(Turn turn) : turn_(turn) {}
  ~HeldTurn() {
    if (lease_ && turn_ == Turn::kOurs) lease_->release(key_);
  }
  HeldTurn(const HeldTurn&) = delete;
  HeldTurn& operator=(const HeldTurn&) = delete;
  Turn turn() const { return turn_; }

 private:
  GenerationLease* const lease_ = nullptr;
  const BlobKey key_;
  const Turn turn_;
};

}  // namespace farfield
