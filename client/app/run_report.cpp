// SPDX-License-Identifier: Apache-2.0
#include "client/app/run_report.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <ostream>

namespace farfield::client {
namespace {

double share(std::uint64_t part, std::uint64_t whole) {
  return whole == 0 ? 0.0 : static_cast<double>(part) / static_cast<double>(whole);
}

nlohmann::ordered_json to_json(const RunReport& report) {
  const ClientStatistics& s = report.statistics;
  nlohmann::ordered_json json;
  json["scene"] = report.scene;
  json["renderer"] = report.renderer;
  json["mode"] = report.is_lockstep ? "lockstep" : "real time";
  json["interrupted"] = report.is_interrupted;
  json["seconds"] = report.seconds;
  json["walked_m"] = report.walked_m;
  json["frames"] = report.frames;
  json["late_frames"] = report.late_frames;
  json["fallback_frames"] = s.fallback_frames;
  json["frame_ms"] = {{"median", report.median_frame_ms}, {"p99", report.p99_frame_ms}};
  json["void_share"] = share(report.void_pixels, report.pixels);
  json["crack_share"] = share(report.crack_pixels, report.pixels);
  const auto figure = [](double value) { return std::isfinite(value) ? nlohmann::ordered_json(value) : nlohmann::ordered_json(nullptr); };
  json["certificate"] = {{"void_share", figure(report.promised.void_share)},
                         {"psnr_db", figure(report.promised.psnr_db)},
                         {"warp_px", figure(report.promised.warp_px)}};
  json["entry"] = {{"bytes", s.entry_bytes}, {"seconds", s.entry_seconds}};
  json["bytes"] = {{"in", s.bytes_in},
                   {"out", s.bytes_out},
                   {"warm", warm_bytes(s)},
                   {"tile_colour", s.tile_colour_bytes},
                   {"tile_disparity", s.tile_disparity_bytes},
                   {"tile_other", s.tile_other_bytes},
                   {"chunks", s.chunk_bytes},
                   {"textures", s.texture_bytes},
                   {"control", s.control_bytes}};
  json["payloads"] = {{"tiles", s.tiles},          {"chunks", s.chunks},
                      {"texture_levels", s.texture_levels}, {"redundant", s.redundant_payloads},
                      {"bad", s.bad_payloads},     {"evicted", s.evicted_payloads},
                      {"given_up", s.given_up}};
  json["leaf_sets"] = s.leaf_sets;
  json["switches"] = s.switches;
  json["poses"] = s.poses;
  json["reconnects"] = s.reconnects;
  json["decode_seconds"] = s.decode_seconds;
  json["round_trip_ms"] = 1e3 * s.round_trip_seconds;
  json["store"] = {{"bytes", s.store_bytes}, {"items", s.store_items}};
  return json;
}

std::string to_text(const RunReport& report) {
  const ClientStatistics& s = report.statistics;
  constexpr double kMega = 1e6;
  const double warm_mbit_s = report.seconds > 0 ? 8.0 * static_cast<double>(warm_bytes(s)) / report.seconds / kMega : 0.0;
  std::string text = fmt::format("{}: {} frames in {:.1f} s{}, {:.1f} m walked, {} renderer\n", report.scene, report.frames,
                                 report.seconds, report.is_interrupted ? " (interrupted)" : "", report.walked_m,
                                 report.renderer);
  text += fmt::format("  frame     {:.1f} ms median, {:.1f} ms p99\n", report.median_frame_ms, report.p99_frame_ms);
  text += fmt::format("  late      {} frames ({:.1f} %), {} of them with the fallback view\n", report.late_frames,
                      100 * share(report.late_frames, report.frames), s.fallback_frames);
  text += fmt::format("  voids     {:.4f} % of the pixels filled, {:.3f} % cracks closed\n",
                      100 * share(report.void_pixels, report.pixels), 100 * share(report.crack_pixels, report.pixels));
  if (std::isfinite(report.promised.psnr_db))
    text += fmt::format("  promised  impostors within {:.1f} dB of truth, voids below {:.3f} %, displaced by less than {:.2f} pixels\n",
                        report.promised.psnr_db, 100 * report.promised.void_share, report.promised.warp_px);
  text += fmt::format("  entry     {:.2f} MB in {:.2f} s; then {:.2f} Mbit/s\n", static_cast<double>(s.entry_bytes) / kMega,
                      s.entry_seconds, warm_mbit_s);
  text += fmt::format("  received  {} tiles {:.2f} MB (colour {:.2f}, disparity {:.2f}), {} chunks {:.2f} MB, {} texture levels {:.2f} MB\n",
                      s.tiles, static_cast<double>(s.tile_bytes()) / kMega, static_cast<double>(s.tile_colour_bytes) / kMega,
                      static_cast<double>(s.tile_disparity_bytes) / kMega, s.chunks,
                      static_cast<double>(s.chunk_bytes) / kMega, s.texture_levels,
                      static_cast<double>(s.texture_bytes) / kMega);
  text += fmt::format("  held      {:.1f} MB in {} items; {} payloads evicted, {} given up, {} bad\n",
                      static_cast<double>(s.store_bytes) / kMega, s.store_items, s.evicted_payloads, s.given_up,
                      s.bad_payloads);
  text += fmt::format("  network   {:.1f} ms round trip, {} reconnects; {:.2f} s of decoding\n", 1e3 * s.round_trip_seconds,
                      s.reconnects, s.decode_seconds);
  return text;
}

}  // namespace

std::uint64_t warm_bytes(const ClientStatistics& statistics) {
  const std::uint64_t all = statistics.bytes_in + statistics.bytes_out;
  return statistics.entry_bytes > 0 ? all - statistics.entry_bytes : 0;
}

void write_report(const RunReport& report, bool is_json, std::ostream& out) {
  out << (is_json ? to_json(report).dump(2) + "\n" : to_text(report)) << std::flush;
}

}  // namespace farfield::client
