// SPDX-License-Identifier: Apache-2.0
// Conditions on a load test's report, as written on the command line: "cell_ready_p95<250ms", "late_share<1%", "errors<1".
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "common/base/result.h"

namespace farfield::client {

struct Threshold {
  std::string text;    // as it was written
  std::string figure;  // cell_ready_p95, …
  double below = 0;    // in the report's unit: milliseconds, or as it stands
};

/// Figures: connect, first_picture, first_cell, cell_ready, away or own_lag with _p50 _p90 _p95 _p99 _p999 or _max (in us, ms or s);
/// late_share (a share or a percentage), mbit_s_per_client, bytes, errors (all kinds), never_ready. Errors: kInvalidArgument.
Result<Threshold> parse_threshold(std::string_view text);

struct Verdict {
  bool is_met = false;
  double measured = 0;  // NaN: there was nothing to measure, which meets no threshold but that of away
};
Verdict judge(const Threshold& threshold, const nlohmann::json& report);

}  // namespace farfield::client
