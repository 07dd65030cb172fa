// SPDX-License-Identifier: Apache-2.0
// What one method amounts to; NaN where a figure does not apply. Definitions: design.md section 9.
#pragma once

#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "common/impostor/frame_promise.h"
#include "server/schedule/cell_statistics.h"

namespace farfield::bench {

inline const double kNone = std::nan("");

struct ErrorFigures {
  double psnr_mean = kNone, psnr_min = kNone;
  // Over the pixels whose true surface lies outside the near region of the viewer's leaf cell (viewer_cells.h), so over
  // the same pixels for every method. NaN in runs of methods none of which has cells.
  double impostor_psnr_mean = kNone, impostor_psnr_min = kNone;
  double ssim_mean = kNone, ssim_min = kNone;
  double flip_mean = kNone, flip_max = kNone;
  double void_mean = kNone, void_max = kNone;
  double warp_px_p99 = kNone;
};

/// What a method's impostors promise of themselves, over the cells of the run, and how often frames keep it.
struct CertificateFigures {
  double void_share = kNone, psnr_db = kNone, warp_px = kNone;  // means of the promises
  double holds_share = kNone;                                   // of the judged frames
  // How far frames stay on the good side, means; negative: they are worse.
  double void_slack = kNone, psnr_slack_db = kNone, warp_slack_px = kNone;
};

/// One frame's promise beside what the judge measured; NaN where it did not.
struct KeptPromise {
  FramePromise promise;
  double void_share = kNone, psnr_db = kNone, warp_px = kNone;

  /// Nothing that was both promised and measured is worse than promised.
  bool holds() const;
};

/// How much the mean FLIP against truth changes from a frame to the next (border_pairs.h).
struct BorderFlip {
  double inside_p99 = kNone, crossing_p99 = kNone;
  double after_crossing_p99 = kNone;  // in the quarter second after the border
};

/// What a skip spared the server or the link; NaN where that is not what it saves.
struct Saving {
  std::string skip, counter;
  double count = 0;
  double rays = kNone, ms = kNone, bytes = kNone;
};

struct MethodResult {
  std::string name;
  double frame_p50 = kNone, frame_p95 = kNone, frame_p99 = kNone;               // ms, lockstep
  double realtime_frame_p50 = kNone, realtime_frame_p99 = kNone;
  double cell_p50 = kNone, cell_p95 = kNone, cell_max = kNone, intra_p50 = kNone;  // ms
  double cell_to_intra = kNone;  // median over cells of the ratio
  double cell_count = 0;
  std::map<std::string, double> cell_stages;  // ms, means over cells
  double bytes_total = kNone, bytes_entry = kNone, bytes_per_cell = kNone, bytes_per_metre = kNone;
  double bytes_near = kNone, bytes_textures = kNone, bytes_colour = kNone, bytes_disparity = kNone, bytes_other = kNone;
  double bytes_messages = kNone;  // of bytes_other: all but the payloads
  double mbit_s_warm = kNone;
  double depth_bits = kNone;
  double triangles = kNone, samples = kNone;
  double late_share = kNone, fallback_share = kNone;
  double realtime_mbit_s = kNone;
  double blank_frames = kNone;
  double client_rss_mb = kNone, server_rss_mb = kNone;
  ErrorFigures error, realtime_error;
  CertificateFigures certificate;
  std::vector<KeptPromise> kept_promises;  // lockstep, by frame
  BorderFlip border_flip;
  std::map<std::string, double> skipped;
  std::vector<CellStatistics> explained;  // --explain: what each cell left out (explain.h); empty else
  std::vector<Saving> savings;            // likewise
  std::vector<std::vector<std::uint8_t>> pictures;  // RGB of the sampled lockstep frames, for the contact sheet
};

}  // namespace farfield::bench
