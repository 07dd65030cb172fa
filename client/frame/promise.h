// SPDX-License-Identifier: Apache-2.0
// What the certificates of a leaf set promise for a frame drawn of it.
#pragma once

#include "client/store/leaf_view.h"
#include "common/impostor/frame_promise.h"

namespace farfield::client {

/// NaN for fallback views, for sets that are not complete and for eyes they do not speak for: nothing is promised there.
/// `samples_per_pixel`: 1 or 4. O(tiles), some microseconds each.
FramePromise promise_of(const LeafView& leaf, const Pose& eye, const Display& display, int samples_per_pixel, bool is_mesh);

/// Means over the frames for which something was promised.
class PromiseMeans {
 public:
  void add(const FramePromise& promise);
  /// Of its expectations nothing is kept.
  FramePromise means() const;

 private:
  double void_share_ = 0, psnr_db_ = 0, warp_px_ = 0;
  std::uint64_t voids_ = 0, colours_ = 0, warps_ = 0;
};

}  // namespace farfield::client
