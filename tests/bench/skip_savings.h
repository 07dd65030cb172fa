// SPDX-License-Identifier: Apache-2.0
// What each skip saved on a walk, measured by doing on a few cells what was skipped.
#pragma once

#include "tests/bench/method_result.h"
#include "tests/bench/world.h"

namespace farfield::bench {

/// Per skip, over the walk: rays not cast, thread milliseconds and bytes not spent; NaN where that is not what it saves.
/// Counts are the server's own (`result.skipped`); what one of them costs is measured on up to twelve of the walk's leaves, one
/// thread, alone: tiles that are not listed are made (every so many-th), tiles are cast with what is hidden, views are
/// searched for without a target. Some seconds to a minute. Requires: result.explained, settings for the scene.
std::vector<Saving> measure_savings(const World& world, const ImpostorSettings& settings, const MethodResult& result);

}  // namespace farfield::bench
