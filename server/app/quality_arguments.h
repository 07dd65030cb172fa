// SPDX-License-Identifier: Apache-2.0
// The options that decide what impostors are worth: one name each, wherever impostors are made.
#pragma once

#include "common/base/command_line.h"
#include "common/impostor/settings.h"

namespace farfield {

/// `settings` must outlive the parsing of `app`; what it holds before is the default.
inline void add_quality_options(CLI::App& app, ImpostorSettings& settings) {
  app.add_option("--tau", settings.tau_px, "Guaranteed warp error of coded disparity, pixels")
      ->check(number_between(0.01, 16))
      ->capture_default_str();
  app.add_option("--face-tiles", settings.face_tiles, "Tiles along a face's edge: the sample rate; 0: what the display needs")
      ->check(whole_number_between(0, 64))
      ->capture_default_str();
  app.add_option("--quality", settings.colour_quality, "quality of colours on the scale of JPEG")
      ->check(whole_number_between(1, 100))
      ->capture_default_str();
  app.add_option("--delta-views", settings.delta_views, "Delta views per cell, at most")
      ->check(whole_number_between(0, 32))
      ->capture_default_str();
  app.add_option("--void-target", settings.void_target, "Share of the sphere below which voids get no further delta view")
      ->check(number_between(0, 1))
      ->capture_default_str();
  app.add_flag("--one-slope", settings.has_one_slope, "Code colours so that each byte buys the same error as seen, not the same per sample");
  app.add_option("--cell-bytes", settings.rate.cell_bytes, "Bytes of a cell's own impostor as one leaf needs it: quality, delta views and depth follow; 0: no budget")
      ->check(number_between(0, 1e9))
      ->capture_default_str();
  app.add_option("--target-psnr", settings.rate.psnr_db, "What coding may leave of a cell's colours, decibels: quality follows; 0: no target")
      ->check(number_between(0, 60))
      ->capture_default_str();
  app.add_option("--certified-void", settings.targets.void_share, "Share of directions with voids above which validation adds delta views; 0: never")
      ->check(number_between(0, 1))
      ->capture_default_str();
  app.add_option("--certified-psnr", settings.targets.coding_psnr_db, "decibels below which a tile's colours are coded finer; 0: never")
      ->check(number_between(0, 60))
      ->capture_default_str();
  app.add_option("--near-triangles", settings.near_triangles, "Budget of near geometry, triangles")
      ->check(whole_number_between(100, 100'000'000))
      ->capture_default_str();
  app.add_option("--finest-side", settings.finest_side_m, "Side of the smallest cells, metres; halved while the scene is smaller than it needs")
      ->check(number_between(0.001, 1e6))
      ->capture_default_str();
}

}  // namespace farfield
