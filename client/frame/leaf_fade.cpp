// SPDX-License-Identifier: Apache-2.0
#include "client/frame/leaf_fade.h"

#include <algorithm>
#include <utility>

namespace farfield::client {
namespace {

bool is_whole(const LeafView& leaf) { return leaf.is_complete && !leaf.is_fallback; }

/// Of the way from the leaf's border to the reach; 1 on the other side of a wall.
double share_of_reach(const LeafView& leaf, const glm::dvec3& eye) {
  if (leaf.leaf_box.contains(eye) && !leaf.speaks_for(eye)) return 1;
  const glm::dvec3 beyond = glm::max(leaf.leaf_box.min - eye, eye - leaf.leaf_box.max);
  const double outside_m = std::max({beyond.x, beyond.y, beyond.z, 0.0});
  return std::min(1.0, outside_m / (LeafFade::kReachSides * leaf.leaf_box.extent().x));
}

}  // namespace

bool LeafFade::may_fade(const LeafView& newest, std::optional<double> time_s) const {
  return seconds_ > 0 && time_s && last_s_ && *time_s >= *last_s_ && shown_ && is_whole(newest) && is_whole(*shown_);
}

std::vector<std::shared_ptr<const LeafView>> LeafFade::in_use(std::optional<double> time_s) const {
  std::vector<std::shared_ptr<const LeafView>> result;
  // After a longer pause the next set is shown at once.
  if (!time_s || !last_s_ || *time_s < *last_s_ || *time_s - *last_s_ >= seconds_) return result;
  for (const auto& leaf : {shown_, former_})
    if (leaf) result.push_back(leaf);
  return result;
}

LeafFade::Mix LeafFade::next(const std::shared_ptr<const LeafView>& newest, const glm::dvec3& eye, std::optional<double> time_s) {
  if (!may_fade(*newest, time_s)) {
    former_ = nullptr, shown_ = newest, last_s_ = time_s;
    return {shown_, nullptr, 1};
  }
  const auto passed = [&] { return std::max((*time_s - start_s_) / seconds_, share_of_reach(*former_, eye)); };
  if (former_ && passed() >= 1) former_ = nullptr;
  if (newest->is_same_set(*shown_)) {
    shown_ = newest;  // perhaps a fuller version
  } else if (!former_) {
    former_ = std::exchange(shown_, newest);
    start_s_ = *last_s_;
  } else if (share_of_reach(*shown_, eye) >= 1) {
    former_ = nullptr, shown_ = newest;  // too far gone for it to have its turn
  }
  last_s_ = time_s;
  if (former_ && passed() >= 1) former_ = nullptr;
  if (!former_) return {shown_, nullptr, 1};
  // Slow at both ends: an error is seen (and FLIP measures it) by a power below one, so that the first hundredth of another
  // picture shows more than any other.
  const double t = passed();
  return {shown_, former_, t * t * (3 - 2 * t)};
}

}  // namespace farfield::client
