// SPDX-License-Identifier: Apache-2.0
#include "common/net/outbox.h"

#include <algorithm>
#include <utility>

namespace farfield {

Outbox::Outbox(std::size_t budget_bytes, std::size_t control_budget_bytes)
    : budget_bytes_(budget_bytes), control_budget_bytes_(control_budget_bytes) {}

bool Outbox::push(OutgoingFrame frame, Lane lane) {
  const auto at = static_cast<std::size_t>(lane);
  if (lane == Lane::kControl ? bytes_[at] >= control_budget_bytes_ : !has_room()) return false;
  bytes_[at] += frame.size();
  lanes_[at].push_back(std::move(frame));
  return true;
}

std::vector<OutgoingFrame> Outbox::take(std::size_t max_frames, std::size_t max_bytes) {
  std::vector<OutgoingFrame> taken;
  std::size_t taken_bytes = 0;
  for (std::size_t lane = 0; lane < lanes_.size(); ++lane) {
    while (!lanes_[lane].empty() && taken.size() < max_frames) {
      const std::size_t size = lanes_[lane].front().size();
      if (!taken.empty() && taken_bytes + size > max_bytes) return taken;
      taken.push_back(std::move(lanes_[lane].front()));
      lanes_[lane].pop_front();
      bytes_[lane] -= size;
      taken_bytes += size;
    }
  }
  return taken;
}

std::vector<std::uint64_t> Outbox::discard(Lane lane) {
  const auto at = static_cast<std::size_t>(lane);
  std::vector<std::uint64_t> tags;
  tags.reserve(lanes_[at].size());
  for (const OutgoingFrame& frame : lanes_[at]) tags.push_back(frame.tag);
  lanes_[at].clear();
  bytes_[at] = 0;
  return tags;
}

bool Outbox::is_empty() const {
  return std::all_of(lanes_.begin(), lanes_.end(), [](const auto& lane) { return lane.empty(); });
}

}  // namespace farfield
