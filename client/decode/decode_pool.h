// SPDX-License-Identifier: Apache-2.0
// Threads that decode payloads off the render and network threads, what is needed now first.
#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

#include "client/decode/payload_decoder.h"

namespace farfield::client {

/// Lower is sooner. Within a group payloads are decoded in the order they came: the server sends what matters first.
enum class DecodeGroup : std::uint8_t {
  kFallback,    // something to show at once
  kNeeded,      // the leaf set the eye is waiting for
  kRefinement,  // finer texture levels
  kPrefetch,    // leaf sets the viewer may enter later
};
inline constexpr int kDecodeGroups = 4;

class DecodePool {
 public:
  /// Called on a pool thread, once for every payload submitted and not discarded.
  using Done = std::function<void(const PayloadName&, Result<DecodedPayload>)>;

  /// Requires: threads >= 1; `done` is callable until the destructor returns.
  DecodePool(PayloadDecoder decoder, int threads, Done done);
  /// Discards what still waits and joins; `done` may be running until this returns.
  ~DecodePool();
  DecodePool(const DecodePool&) = delete;
  DecodePool& operator=(const DecodePool&) = delete;

  void submit(EncodedPayload payload, DecodeGroup group);
  /// Sorts what waits anew, after the viewer's needs have changed. O(waiting).
  void regroup(const std::function<DecodeGroup(const PayloadName&)>& group_of);
  /// Encoded bytes waiting: the measure for back-pressure on the socket.
  std::size_t queued_bytes() const;

 private:
  void run();

  const PayloadDecoder decoder_;
  const Done done_;
  mutable std::mutex mutex_;  // guards what follows
  std::condition_variable wake_;
  std::deque<EncodedPayload> waiting_[kDecodeGroups];
  std::size_t queued_bytes_ = 0;
  bool is_stopping_ = false;
  std::vector<std::thread> threads_;
};

}  // namespace farfield::client
