// SPDX-License-Identifier: Apache-2.0
// Holds what impostors promise of themselves against what the judge measures, frame by frame.
#pragma once

#include <nlohmann/json.hpp>
#include <vector>

#include "tests/bench/method_result.h"

namespace farfield::bench {

/// As the client role sends promises of its frames: an array of five numbers, null where nothing is promised.
FramePromise promise_from(const nlohmann::json& json);
nlohmann::json to_json(const FramePromise& promise);

/// A frame of a report, both ways.
nlohmann::json to_json(const KeptPromise& frame);
/// Throws nlohmann::json::exception where it is something else.
KeptPromise kept_promise_from(const nlohmann::json& json);

/// Means of the promises and the share of frames that keep theirs; frames that promise nothing are left out.
CertificateFigures certificate_figures(const std::vector<KeptPromise>& frames);

}  // namespace farfield::bench
