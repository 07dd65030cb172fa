// SPDX-License-Identifier: Apache-2.0
#include "client/load/load_report.h"

#include <fmt/format.h>

#include <cmath>
#include <ostream>

namespace farfield::client {
namespace {

nlohmann::json value(double figure) { return std::isfinite(figure) ? nlohmann::json(figure) : nlohmann::json(nullptr); }

nlohmann::json milliseconds(const LatencySamples& samples) {
  const Percentiles p = samples.percentiles();
  const auto ms = [](double seconds) { return value(1e3 * seconds); };
  return {{"p50", ms(p.p50)}, {"p90", ms(p.p90)}, {"p95", ms(p.p95)}, {"p99", ms(p.p99)}, {"p999", ms(p.p999)}, {"max", ms(p.max)}, {"count", samples.count()}};
}

nlohmann::json link_json(const LinkModel& link) {
  if (link.is_none()) return nlohmann::json::object();
  return {{"rate_bit_s", link.rate_bits_per_second}, {"delay_ms", 1e3 * link.delay.count()}, {"jitter_ms", 1e3 * link.jitter.count()}, {"loss", link.loss}, {"cut_s", link.cut.count()}};
}

std::string text_of(const nlohmann::json& figure) {
  return figure.is_number() ? fmt::format("{:9.1f}", figure.get<double>()) : fmt::format("{:>9}", "-");
}

}  // namespace

nlohmann::json load_report(const LoadOptions& options, const LoadOutcome& outcome, const CellsMade& made) {
  const WalkerFigures& f = outcome.figures;
  const ClientStatistics& s = f.statistics;
  const auto bytes = static_cast<double>(s.bytes_in + s.bytes_out);
  nlohmann::json errors = nlohmann::json::object();
  for (const auto& [kind, count] : f.errors) errors[kind] = count;
  if (f.never_connected > 0) errors["never_connected"] = f.never_connected;
  if (s.bad_payloads > 0) errors["bad_payload"] = s.bad_payloads;
  return {{"format", "farfield-load/1"},
          {"clients", outcome.arrived},
          {"seconds", outcome.seconds},
          {"is_interrupted", outcome.is_interrupted},
          {"link", link_json(options.link)},
          {"connect_ms", milliseconds(f.connect)},
          {"first_picture_ms", milliseconds(f.first_picture)},
          {"first_cell_ms", milliseconds(f.first_cell)},
          {"cell_ready_ms", milliseconds(f.cell_ready)},
          {"never_ready", f.never_ready},
          {"late_share", s.frames > 0 ? value(static_cast<double>(s.late_frames) / static_cast<double>(s.frames)) : value(NAN)},
          {"bytes", s.bytes_in + s.bytes_out},
          {"mbit_s_per_client", f.seconds > 0 ? value(8e-6 * bytes / f.seconds) : value(NAN)},
          {"payloads", s.tiles + s.chunks + s.texture_levels},
          {"cells", {{"made", made ? nlohmann::json(*made) : nlohmann::json(nullptr)}, {"served", s.leaf_sets}}},
          {"errors", errors},
          {"reconnects", s.reconnects},
          {"away_ms", milliseconds(f.away)},
          {"own_lag_ms", milliseconds(outcome.own_lag)},
          {"own_cpu_s", outcome.own_cpu_s},
          {"decode_cpu_s", s.decode_seconds}};
}

void print_load_report(const nlohmann::json& report, std::ostream& out) {
  out << fmt::format("{} clients, {:.1f} s\n{:<16}{:>9}{:>9}{:>9}{:>9}{:>9}{:>9}{:>9}\n", report["clients"].get<std::size_t>(), report["seconds"].get<double>(),
                     "milliseconds", "p50", "p90", "p95", "p99", "p99.9", "max", "count");
  for (const char* name : {"connect_ms", "first_picture_ms", "first_cell_ms", "cell_ready_ms", "away_ms", "own_lag_ms"}) {
    const nlohmann::json& row = report[name];
    out << fmt::format("{:<16}", name);
    for (const char* column : {"p50", "p90", "p95", "p99", "p999", "max"}) out << text_of(row[column]);
    out << fmt::format("{:>9}\n", row["count"].get<std::size_t>());
  }
  const auto percent = [](const nlohmann::json& share) { return share.is_number() ? fmt::format("{:.2f} %", 100 * share.get<double>()) : std::string("-"); };
  const auto number = [](const nlohmann::json& figure) { return figure.is_number() ? fmt::format("{:.3f}", figure.get<double>()) : std::string("-"); };
  out << fmt::format("frames with a late cell {}, cells never ready {}, cells served {}, made {}\n", percent(report["late_share"]),
                     report["never_ready"].get<std::uint64_t>(), report["cells"]["served"].get<std::uint64_t>(), report["cells"]["made"].dump());
  out << fmt::format("{:.1f} MB, {} Mbit/s per client\n", 1e-6 * report["bytes"].get<double>(), number(report["mbit_s_per_client"]));
  out << fmt::format("errors {}, reconnects {}\n", report["errors"].dump(), report["reconnects"].get<std::uint64_t>());
  out << fmt::format("this program: {:.1f} s of processor time\n", report["own_cpu_s"].get<double>());
}

}  // namespace farfield::client
