// SPDX-License-Identifier: Apache-2.0
// What one method amounts to; NaN where a figure does not apply. Definitions: design.md section 9.
#pragma once

#include <cmath>
#include <map>
#include <string>
#include <vector>

namespace farfield::bench {

inline const double kNone = std::nan("");

struct ErrorFigures {
  double psnr_mean = kNone, psnr_min = kNone;
  double impostor_psnr_mean = kNone, impostor_psnr_min = kNone;
  double ssim_mean = kNone, ssim_min = kNone;
  double flip_mean = kNone, flip_max = kNone;
  double void_mean = kNone, void_max = kNone;
  double warp_px_p99 = kNone;
};

struct MethodResult {
  std::string name;
  double frame_p50 = kNone, frame_p95 = kNone, frame_p99 = kNone;               // ms, lockstep
  double realtime_frame_p50 = kNone, realtime_frame_p99 = kNone;
  double cell_p50 = kNone, cell_p95 = kNone, cell_max = kNone, intra_p50 = kNone;  // ms
  double cell_to_intra = kNone;  // median over cells of the ratio
  double cell_count = 0;
  double bytes_total = kNone, bytes_entry = kNone, bytes_per_cell = kNone, bytes_per_metre = kNone;
  double bytes_near = kNone, bytes_textures = kNone, bytes_colour = kNone, bytes_disparity = kNone, bytes_other = kNone;
  double mbit_s_warm = kNone;
  double depth_bits = kNone;
  double triangles = kNone, samples = kNone;
  double late_share = kNone, fallback_share = kNone;
  double realtime_mbit_s = kNone;
  double blank_frames = kNone;
  double client_rss_mb = kNone, server_rss_mb = kNone;
  ErrorFigures error, realtime_error;
  std::map<std::string, double> skipped;
  std::vector<std::vector<std::uint8_t>> pictures;  // RGB of the sampled lockstep frames, for the contact sheet
};

}  // namespace farfield::bench
