// SPDX-License-Identifier: Apache-2.0
// One figure of a server's /metrics page.
#pragma once

#include <string_view>

#include "common/net/endpoint.h"

namespace farfield::client {

inline constexpr std::string_view kLeafPlansMetric = "farfield_leaf_plans_made_total";

/// Summed over its labels. Blocks, a few seconds at most. Errors: kUnavailable (nobody answers there), kNotFound (no such metric).
Result<double> read_metric(const Endpoint& admin, std::string_view name);
/// Of the page's text.
Result<double> metric_of(std::string_view page, std::string_view name);

}  // namespace farfield::client
