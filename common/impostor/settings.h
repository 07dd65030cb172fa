// SPDX-License-Identifier: Apache-2.0
// Everything that decides what a cell's impostor contains. Its hash, with the scene's, is part of every cache key.
#pragma once

#include <cstdint>

#include "common/base/hash.h"
#include "common/impostor/tile_id.h"
#include "common/math/camera.h"

namespace farfield {

/// What certificates must show, or more is spent on the impostor: chosen so that most never need it. 0: no target.
struct CertificateTargets {
  double void_share = 2.5e-4;    // of directions: above it, delta views are added where validation saw most voids, within the budget
  double coding_psnr_db = 30;    // of a tile's decoded colours against those cast: below it, the tile is coded finer
};

/// What a cell's own shell may cost or must be worth; with either, colours, delta views and disparity are coded as the cell needs
/// (server/encode/rate_control.h) instead of at fixed settings. Both: as good as asked for, within the bytes. 0: no target.
struct RateTargets {
  double cell_bytes = 0;  // encoded tiles of the shell that viewers in one leaf need
  double psnr_db = 0;     // of decoded colours against those cast, over all directions in which the shell is seen
  bool is_set() const { return cell_bytes > 0 || psnr_db > 0; }
};

struct ImpostorSettings {
  double finest_side_m = 0.5;        // side of a level-0 cell: the floor of subdivision
  double kappa = 2.0;                // margin of the near region, in sides
  int face_tiles = 12;               // tiles along a face's edge: the sample rate, see face_tiles_for()
  double tau_px = 1.0;               // guaranteed warp error of coded disparity, in pixels of `display`
  Display display;                   // what tau and the sample rate are meant for
  /// P: the geometry budget. More means larger leaves: fewer bytes and errors as viewers walk, and voids and draw time that
  /// grow. 100000 takes twice the time in scenes that are small enough to fall into it whole.
  std::uint32_t near_triangles = 60000;
  int delta_views = 8;               // at most
  double void_target = 6e-5;         // stop adding delta views below this share of the sphere
  int colour_quality = 80;           // 1 … 100, on the scale of JPEG
  bool has_one_slope = false;        // each byte of colour buys the same error as seen by viewers, instead of the same per sample
  CertificateTargets targets;
  RateTargets rate;

  /// Samples along a face's edge of a view. Delta views have seven tenths of the intra view's: what they hold is seen
  /// past the rims of nearer things, and at the full rate it would be half as much again as the intra view.
  int edge_samples(std::uint8_t view = kIntraView) const {
    const bool is_delta = view != kIntraView && view != kFallbackView;
    return face_samples(is_delta ? (7 * face_tiles + 5) / 10 : face_tiles);
  }
  ContentHash hash() const;
};

/// Tiles along a face's edge for `rate` samples per pixel in the worst place of a cell (design.md section 2: one sample
/// per pixel there is 1560 samples at 720p and 60 degrees). At 0.8, one sample per pixel at the cell's centre, frames are half
/// a decibel to one and a half worse for a fifth to a quarter fewer bytes.
int face_tiles_for(const Display& display, double kappa, double rate = 1.0);

}  // namespace farfield
