// SPDX-License-Identifier: Apache-2.0
#include "client/load/threshold.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>

namespace farfield::client {
namespace {

constexpr std::array<std::string_view, 6> kLatencies{"connect", "first_picture", "first_cell", "cell_ready", "away", "own_lag"};
constexpr std::array<std::string_view, 6> kQuantiles{"p50", "p90", "p95", "p99", "p999", "max"};
constexpr std::array<std::string_view, 5> kPlain{"late_share", "mbit_s_per_client", "bytes", "errors", "never_ready"};

template <std::size_t N>
bool is_one_of(std::string_view name, const std::array<std::string_view, N>& names) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

struct LatencyName {
  std::string_view latency, quantile;
};

// "cell_ready_p95" as both of its halves; empty ones if it is no latency.
LatencyName latency_of(std::string_view figure) {
  const std::size_t underscore = figure.rfind('_');
  if (underscore == figure.npos) return {};
  const LatencyName name{figure.substr(0, underscore), figure.substr(underscore + 1)};
  return is_one_of(name.latency, kLatencies) && is_one_of(name.quantile, kQuantiles) ? name : LatencyName{};
}

// What a number with this unit counts in the report's; 0: no such unit.
double scale_of(std::string_view unit, bool is_latency, std::string_view figure) {
  if (is_latency) return unit == "ms" ? 1 : unit == "s" ? 1e3 : unit == "us" ? 1e-3 : 0;
  if (unit == "%") return figure == "late_share" ? 0.01 : 0;
  return unit.empty() ? 1 : 0;
}

}  // namespace

Result<Threshold> parse_threshold(std::string_view text) {
  const auto wrong = [&] {
    return fail(ErrorCode::kInvalidArgument, "'{}' is no threshold: write FIGURE<VALUE, as in cell_ready_p95<250ms, late_share<1% or errors<1", text);
  };
  const std::size_t sign = text.find('<');
  if (sign == text.npos) return wrong();
  Threshold threshold{std::string(text), std::string(text.substr(0, sign)), 0};
  const bool is_latency = !latency_of(threshold.figure).latency.empty();
  if (!is_latency && !is_one_of(threshold.figure, kPlain)) return wrong();
  const char* const end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data() + sign + 1, end, threshold.below);
  if (error != std::errc{} || !std::isfinite(threshold.below)) return wrong();
  const double scale = scale_of({rest, static_cast<std::size_t>(end - rest)}, is_latency, threshold.figure);
  if (!(scale > 0)) return wrong();
  threshold.below *= scale;
  return threshold;
}

Verdict judge(const Threshold& threshold, const nlohmann::json& report) {
  const LatencyName name = latency_of(threshold.figure);
  nlohmann::json figure;
  if (!name.latency.empty()) {
    figure = report.at(std::string(name.latency) + "_ms").at(std::string(name.quantile));
    if (name.latency == "away" && figure.is_null()) figure = 0.0;  // nobody was
  } else if (threshold.figure == "errors") {
    std::uint64_t all = 0;
    for (const auto& [kind, count] : report.at("errors").items()) all += count.get<std::uint64_t>();
    figure = all;
  } else {
    figure = report.at(threshold.figure);
  }
  if (!figure.is_number()) return {false, std::numeric_limits<double>::quiet_NaN()};
  const double measured = figure.get<double>();
  return {measured < threshold.below, measured};
}

}  // namespace farfield::client
