// SPDX-License-Identifier: Apache-2.0
// The server's messages from its own nouns, and a client's pose checked.
#pragma once

#include <span>

#include "common/math/camera.h"
#include "common/net/frame.h"
#include "server/schedule/cell_service.h"
#include "server/session/server_limits.h"

namespace farfield::wire {
class Pose;
}

namespace farfield {

struct SessionGreeting {
  std::string resume_token;
  bool resumed = false;
  std::uint32_t version = kProtocolVersionMax;
};

OutgoingFrame welcome_message(const SessionGreeting& greeting, const ServerLimits& limits,
                              std::span<const std::shared_ptr<CellService>> catalogue, const SceneDescription& scene);
OutgoingFrame failure_message(const Error& error, bool is_fatal);
OutgoingFrame go_away_message(const std::string& reason, const std::string& resume_token,
                              std::chrono::milliseconds retry_after);

struct LeafSetHead {
  std::uint64_t serial = 0;
  bool is_current = true;
};
/// The manifest of a plan's leaf set. Placements are relative to the centre of the leaf.
OutgoingFrame leaf_set_message(const LeafSetHead& head, const CellService& service, const LeafPlan& plan);
OutgoingFrame leaf_set_complete_message(std::uint64_t serial);

/// The pose in the scene frame, rotation normalised. Errors: kBadData (a cell off the grid, numbers that are no pose).
Result<Pose> to_pose(const wire::Pose& message, const CellGrid& grid);

}  // namespace farfield
