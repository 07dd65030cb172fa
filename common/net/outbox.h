// SPDX-License-Identifier: Apache-2.0
// What waits to be written on one connection: three lanes and a byte budget.
//
// Control frames go before payloads, payloads of the current leaf before prefetched ones; within a lane first in,
// first out. The budget is the back-pressure: whoever makes payloads asks has_room() and stops when there is none.
// Control frames are small and always welcome up to a bound of their own; beyond it the peer is not reading.
// Not thread-safe: one connection's strand owns it.
#pragma once

#include <array>
#include <cstddef>
#include <deque>
#include <vector>

#include "common/net/frame.h"

namespace farfield {

enum class Lane : std::uint8_t { kControl, kPayload, kPrefetch };

class Outbox {
 public:
  /// `budget_bytes` bounds the payload lanes together, `control_budget_bytes` the control lane.
  Outbox(std::size_t budget_bytes, std::size_t control_budget_bytes);

  /// Room for another payload: one frame may exceed the budget, so that a frame of any size can be sent.
  bool has_room() const { return payload_bytes() < budget_bytes_; }
  /// Returns: false, and drops the frame, when the lane's bound is reached.
  bool push(OutgoingFrame frame, Lane lane);
  /// Takes frames for one gathered write: at least one (if any waits), at most `max_frames`, about `max_bytes`.
  std::vector<OutgoingFrame> take(std::size_t max_frames, std::size_t max_bytes);
  /// Drops everything in `lane`. Returns: the tags of what was dropped, in order.
  std::vector<std::uint64_t> discard(Lane lane);

  bool is_empty() const;
  std::size_t bytes() const { return bytes_[0] + bytes_[1] + bytes_[2]; }
  std::size_t payload_bytes() const { return bytes_[1] + bytes_[2]; }

 private:
  std::size_t budget_bytes_, control_budget_bytes_;
  std::array<std::deque<OutgoingFrame>, 3> lanes_;
  std::array<std::size_t, 3> bytes_{};
};

}  // namespace farfield
