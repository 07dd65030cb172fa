// SPDX-License-Identifier: Apache-2.0
#include "client/frame/promise.h"

#include <cmath>

namespace farfield::client {

FramePromise promise_of(const LeafView& leaf, const Pose& eye, const Display& display, int samples_per_pixel, bool is_mesh) {
  if (leaf.is_fallback || !leaf.is_complete || !leaf.speaks_for(eye.position)) return {};
  const double kappa = 0.5 * (leaf.near_region.extent().x / leaf.leaf_box.extent().x - 1);
  PromiseSum sum({eye, display, samples_per_pixel, is_mesh, kappa});
  for (const std::shared_ptr<const DecodedTile>& tile : leaf.tiles)
    sum.add({tile->id, tile->view_position, tile->side_m, tile->edge_samples, tile->covered_samples, tile->tolerance, tile->certificate});
  return sum.promise();
}

void PromiseMeans::add(const FramePromise& promise) {
  if (std::isfinite(promise.void_share)) void_share_ += promise.void_share, ++voids_;
  if (std::isfinite(promise.psnr_db)) psnr_db_ += promise.psnr_db, ++colours_;
  if (std::isfinite(promise.warp_px)) warp_px_ += promise.warp_px, ++warps_;
}

FramePromise PromiseMeans::means() const {
  FramePromise means;
  if (voids_ > 0) means.void_share = void_share_ / static_cast<double>(voids_);
  if (colours_ > 0) means.psnr_db = psnr_db_ / static_cast<double>(colours_);
  if (warps_ > 0) means.warp_px = warp_px_ / static_cast<double>(warps_);
  return means;
}

}  // namespace farfield::client
