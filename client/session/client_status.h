// SPDX-License-Identifier: Apache-2.0
// What a client core tells about itself: its state, the scene it is in, and what it has counted.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <string>

#include "client/store/leaf_set.h"
#include "common/base/result.h"
#include "common/math/box.h"
#include "common/math/camera.h"

namespace farfield::client {

enum class ClientState {
  kConnecting,    // no Welcome yet; tries again until stopped
  kStreaming,
  kReconnecting,  // was streaming; keeps showing what it has
  kFailed,        // final: wrong version, unknown scene, not a Farfield server
  kStopped,
};
const char* client_state_name(ClientState state);

struct ClientStatus {
  ClientState state = ClientState::kConnecting;
  Error error;  // the newest one, in one line; an empty message: none so far
};

/// The scene as the server describes it. Scene frame: metres relative to `origin`, axes as in the world.
struct SceneDescription {
  std::string name;
  ContentHash scene_hash = 0;
  glm::dvec3 origin{0};  // world position of the scene frame's zero
  Box bounds;            // scene frame
  glm::dvec3 start{0};   // a viewpoint where a person can stand, scene frame
  SceneFrame frame;
  double tau_px = 0.25;
  int edge_samples = 0;
  std::uint64_t triangles = 0;

  Pose scene_from_world(const Pose& world) const { return {world.position - origin, world.world_from_camera}; }
  Pose world_from_scene(const Pose& scene) const { return {scene.position + origin, scene.world_from_camera}; }
};

/// Bytes are of frames on the socket; payload kinds count payloads alone, control is everything else that came in.
struct ClientStatistics {
  std::uint64_t bytes_in = 0, bytes_out = 0;
  std::uint64_t tile_colour_bytes = 0, tile_disparity_bytes = 0, tile_other_bytes = 0;
  std::uint64_t chunk_bytes = 0, texture_bytes = 0, control_bytes = 0;
  std::uint64_t tiles = 0, chunks = 0, texture_levels = 0, leaf_sets = 0, poses = 0;
  std::uint64_t redundant_payloads = 0;  // arrived although held
  std::uint64_t bad_payloads = 0;        // did not decode
  std::uint64_t evicted_payloads = 0, given_up = 0;
  std::uint64_t switches = 0;            // of the leaf set on the screen
  std::uint64_t reconnects = 0;
  std::uint64_t frames = 0, late_frames = 0, fallback_frames = 0;
  std::uint64_t entry_bytes = 0;         // in and out until the first leaf set was complete; 0: not yet
  double entry_seconds = 0;
  double decode_seconds = 0;             // thread time
  double round_trip_seconds = 0;         // of the newest ping
  std::size_t store_bytes = 0, store_items = 0;
  std::size_t decode_queue_bytes = 0;

  std::uint64_t tile_bytes() const { return tile_colour_bytes + tile_disparity_bytes + tile_other_bytes; }
};

}  // namespace farfield::client
