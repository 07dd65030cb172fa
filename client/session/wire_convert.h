// SPDX-License-Identifier: Apache-2.0
// Between the messages of proto/farfield.proto and the client's own words. Everything from the server is checked here.
#pragma once

#include "client/session/client_status.h"
#include "client/store/leaf_set.h"
#include "common/base/result.h"

namespace farfield::wire {
class LeafSet;
class Pose;
class SceneInfo;
}  // namespace farfield::wire

namespace farfield::client {

/// Most tiles, and most chunks, one leaf set may list: far above what twenty shells and a near region need.
inline constexpr int kMaxLeafSetItems = 1 << 16;

/// Errors: kBadData (numbers that describe no scene).
Result<SceneDescription> to_scene_description(const wire::SceneInfo& info);
/// Errors: kBadData, kLimitExceeded.
Result<LeafSet> to_leaf_set(const wire::LeafSet& message);

/// The position as the server will understand it: a float offset from the centre of the finest cell that holds it.
/// Both sides decide about leaves with this one, so that rounding never puts them on two sides of a border.
glm::dvec3 position_on_wire(const CellGrid& grid, const glm::dvec3& position);
void fill_pose(const CellGrid& grid, const Pose& pose, wire::Pose& message);

/// Codes of other builds become kInternal.
ErrorCode to_error_code(std::uint32_t code);

}  // namespace farfield::client
