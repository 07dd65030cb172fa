// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/report.h"

#include <fmt/format.h>

#include <cstdlib>
#include <fstream>
#include <iostream>
#include <thread>

#include "tests/bench/explain.h"
#include "tests/bench/promises.h"

namespace farfield::bench {
namespace {

nlohmann::json value(double number) { return std::isfinite(number) ? nlohmann::json(number) : nlohmann::json(nullptr); }

nlohmann::json to_json(const ErrorFigures& e) {
  return {{"psnr_db", {{"mean", value(e.psnr_mean)}, {"min", value(e.psnr_min)}}},
          {"impostor_psnr_db", {{"mean", value(e.impostor_psnr_mean)}, {"min", value(e.impostor_psnr_min)}}},
          {"ssim", {{"mean", value(e.ssim_mean)}, {"min", value(e.ssim_min)}}},
          {"flip", {{"mean", value(e.flip_mean)}, {"max", value(e.flip_max)}}},
          {"void_share", {{"mean", value(e.void_mean)}, {"max", value(e.void_max)}}},
          {"warp_px_p99", value(e.warp_px_p99)}};
}

nlohmann::json promises_json(const std::vector<KeptPromise>& frames) {
  nlohmann::json list = nlohmann::json::array();
  for (const KeptPromise& frame : frames) list.push_back(to_json(frame));
  return list;
}

nlohmann::json values(const std::map<std::string, double>& named) {
  nlohmann::json object = nlohmann::json::object();
  for (const auto& [name, figure] : named) object[name] = value(figure);
  return object;
}

nlohmann::json to_json(const MethodResult& m) {
  nlohmann::json savings = nlohmann::json::array();
  for (const Saving& s : m.savings)
    savings.push_back({{"skip", s.skip}, {"counter", s.counter}, {"count", value(s.count)}, {"rays", value(s.rays)}, {"ms", value(s.ms)}, {"bytes", value(s.bytes)}});
  return {{"name", m.name},
          {"frame_ms", {{"p50", value(m.frame_p50)}, {"p95", value(m.frame_p95)}, {"p99", value(m.frame_p99)}}},
          {"realtime_frame_ms", {{"p50", value(m.realtime_frame_p50)}, {"p99", value(m.realtime_frame_p99)}}},
          {"cell_ms", {{"p50", value(m.cell_p50)}, {"p95", value(m.cell_p95)}, {"max", value(m.cell_max)}, {"count", value(m.cell_count)}}},
          {"cell_stages_ms", values(m.cell_stages)},
          {"intra_ms", {{"p50", value(m.intra_p50)}}},
          {"cell_to_intra", value(m.cell_to_intra)},
          {"bytes", {{"total", value(m.bytes_total)}, {"entry", value(m.bytes_entry)}, {"per_cell", value(m.bytes_per_cell)},
                     {"per_metre", value(m.bytes_per_metre)}, {"near_geometry", value(m.bytes_near)}, {"textures", value(m.bytes_textures)},
                     {"colour", value(m.bytes_colour)}, {"disparity", value(m.bytes_disparity)}, {"other", value(m.bytes_other)}, {"messages", value(m.bytes_messages)}}},
          {"mbit_s_warm", value(m.mbit_s_warm)},
          {"depth_bits_per_covered_pixel", value(m.depth_bits)},
          {"drawn", {{"triangles", value(m.triangles)}, {"samples", value(m.samples)}}},
          {"late_share", value(m.late_share)},
          {"fallback_share", value(m.fallback_share)},
          {"realtime_mbit_s", value(m.realtime_mbit_s)},
          {"blank_frames", value(m.blank_frames)},
          {"peak_rss_mb", {{"client", value(m.client_rss_mb)}, {"server", value(m.server_rss_mb)}}},
          {"error", to_json(m.error)},
          {"realtime_error", to_json(m.realtime_error)},
          {"certificate", {{"void_share", value(m.certificate.void_share)}, {"psnr_db", value(m.certificate.psnr_db)},
                           {"warp_px", value(m.certificate.warp_px)}, {"holds_share", value(m.certificate.holds_share)},
                           {"void_slack", value(m.certificate.void_slack)}, {"psnr_slack_db", value(m.certificate.psnr_slack_db)},
                           {"warp_slack_px", value(m.certificate.warp_slack_px)}, {"frames", promises_json(m.kept_promises)}}},
          {"border_flip", {{"inside_p99", value(m.border_flip.inside_p99)}, {"crossing_p99", value(m.border_flip.crossing_p99)}, {"after_crossing_p99", value(m.border_flip.after_crossing_p99)}}},
          {"skipped", values(m.skipped)},
          {"savings", savings}};
}

nlohmann::json to_json(const Curve& curve) {
  nlohmann::json points = nlohmann::json::array();
  for (const CurvePoint& p : curve.points)
    points.push_back({{"value", p.value}, {"frame_ms", value(p.frame_ms)}, {"mbit_s", value(p.mbit_s)}, {"flip", value(p.flip)}, {"psnr_db", value(p.psnr_db)}});
  return {{"name", curve.method}, {"knob", curve.knob}, {"points", points}};
}

std::string processor_name() {
  std::ifstream in("/proc/cpuinfo");
  for (std::string line; std::getline(in, line);)
    if (line.rfind("model name", 0) == 0) return line.substr(line.find(':') + 2);
  return "unknown";
}

nlohmann::json vector_json(const glm::dvec3& v) { return {v.x, v.y, v.z}; }

std::string cell(double number, const char* format) {
  return std::isfinite(number) ? fmt::format(fmt::runtime(format), number) : std::string("-");
}

}  // namespace

nlohmann::json to_json(const World& world, const std::vector<MethodResult>& methods, const std::vector<Curve>& curves) {
  double load[1] = {0};
  if (getloadavg(load, 1) < 1) load[0] = kNone;
  const LinkModel& link = world.options.link_model;
  nlohmann::json list = nlohmann::json::array();
  for (const MethodResult& m : methods) list.push_back(to_json(m));
  nlohmann::json curve_list = nlohmann::json::array();
  for (const Curve& curve : curves) curve_list.push_back(to_json(curve));
  nlohmann::json link_json = nlohmann::json::object();
  if (!link.is_none())
    link_json = {{"rate_bit_s", link.rate_bits_per_second}, {"delay_ms", 1e3 * link.delay.count()}, {"jitter_ms", 1e3 * link.jitter.count()}, {"loss", link.loss}};
  const Box& bounds = world.scene->bounds();
  return {{"format", "farfield-bench/1"},
          {"machine", {{"cpu", processor_name()}, {"cores", std::thread::hardware_concurrency()}, {"load", value(load[0])}}},
          {"scene", {{"name", world.options.scene}, {"triangles", world.scene->statistics().drawn_triangles},
                     {"bounds", {vector_json(bounds.min + world.scene->origin()), vector_json(bounds.max + world.scene->origin())}}}},
          {"trace", {{"frames", world.trace.frames.size()}, {"metres", length_of(world.trace)}, {"seconds", world.trace.seconds()}}},
          {"display", {{"width", world.options.display.width}, {"height", world.options.display.height},
                       {"fovy_deg", world.options.display.fovy_rad * 180 / 3.14159265358979323846}}},
          {"link", link_json},
          {"methods", list},
          {"curves", curve_list},
          {"explain", explain_json(methods)}};
}

void print_table(const std::vector<MethodResult>& methods, std::ostream& out) {
  struct Column {
    const char* title;
    const char* format;
    double (*figure)(const MethodResult&);
  };
  const Column columns[] = {
      {"frame ms", "{:.1f}", [](const MethodResult& m) { return m.frame_p50; }},
      {"p99", "{:.1f}", [](const MethodResult& m) { return m.frame_p99; }},
      {"PSNR dB", "{:.2f}", [](const MethodResult& m) { return m.error.psnr_mean; }},
      {"impostor", "{:.2f}", [](const MethodResult& m) { return m.error.impostor_psnr_mean; }},
      {"SSIM", "{:.4f}", [](const MethodResult& m) { return m.error.ssim_mean; }},
      {"FLIP", "{:.4f}", [](const MethodResult& m) { return m.error.flip_mean; }},
      {"crossing", "{:.4f}", [](const MethodResult& m) { return m.border_flip.crossing_p99; }},
      {"after", "{:.4f}", [](const MethodResult& m) { return m.border_flip.after_crossing_p99; }},
      {"inside", "{:.4f}", [](const MethodResult& m) { return m.border_flip.inside_p99; }},
      {"void %", "{:.4f}", [](const MethodResult& m) { return 100 * m.error.void_mean; }},
      {"max %", "{:.4f}", [](const MethodResult& m) { return 100 * m.error.void_max; }},
      {"warp px", "{:.3f}", [](const MethodResult& m) { return m.error.warp_px_p99; }},
      {"promised dB", "{:.2f}", [](const MethodResult& m) { return m.certificate.psnr_db; }},
      {"void %", "{:.4f}", [](const MethodResult& m) { return 100 * m.certificate.void_share; }},
      {"px", "{:.3f}", [](const MethodResult& m) { return m.certificate.warp_px; }},
      {"kept %", "{:.1f}", [](const MethodResult& m) { return 100 * m.certificate.holds_share; }},
      {"cell ms", "{:.0f}", [](const MethodResult& m) { return m.cell_p50; }},
      {"/intra", "{:.2f}", [](const MethodResult& m) { return m.cell_to_intra; }},
      {"entry MB", "{:.2f}", [](const MethodResult& m) { return 1e-6 * m.bytes_entry; }},
      {"Mbit/s", "{:.2f}", [](const MethodResult& m) { return m.mbit_s_warm; }},
      {"depth b/px", "{:.3f}", [](const MethodResult& m) { return m.depth_bits; }},
      {"k triangles", "{:.0f}", [](const MethodResult& m) { return 1e-3 * m.triangles; }},
      {"M samples", "{:.2f}", [](const MethodResult& m) { return 1e-6 * m.samples; }},
      {"late %", "{:.1f}", [](const MethodResult& m) { return 100 * m.late_share; }},
      {"rt PSNR", "{:.2f}", [](const MethodResult& m) { return m.realtime_error.psnr_mean; }},
      {"client MB", "{:.0f}", [](const MethodResult& m) { return m.client_rss_mb; }},
  };
  out << fmt::format("{:<16}", "method");
  for (const Column& column : columns) out << fmt::format("{:>12}", column.title);
  out << '\n';
  for (const MethodResult& m : methods) {
    out << fmt::format("{:<16}", m.name);
    for (const Column& column : columns) out << fmt::format("{:>12}", cell(column.figure(m), column.format));
    out << '\n';
  }
}

void print_dominance(const std::vector<MethodResult>& methods, const std::vector<Curve>& curves, std::ostream& out) {
  // A run is a curve of one point.
  std::vector<Curve> all = curves;
  for (const MethodResult& m : methods) all.push_back({m.name, "", {point_of(0, m)}});
  const auto is_farfield = [](const Curve& curve) { return curve.method.starts_with("farfield"); };
  std::map<std::string, std::vector<Curve>> ours;
  for (const Curve& curve : all)
    if (is_farfield(curve)) ours[curve.method].push_back(curve);
  for (const auto& [name, mine] : ours)
    for (const CostAxis& axis : kCostAxes)
      for (const Curve& theirs : all) {
        if (is_farfield(theirs)) continue;
        for (const std::string& line : dominance_report(name, mine, theirs, axis)) out << line << '\n';
      }
}

}  // namespace farfield::bench
