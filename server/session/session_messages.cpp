// SPDX-License-Identifier: Apache-2.0
#include "server/session/session_messages.h"

#include <cmath>

#include "common/net/message.h"
#include "proto/farfield.pb.h"
#include "server/session/payload_order.h"

namespace farfield {
namespace {

void set_vec(wire::Vec3d* out, const glm::dvec3& v) {
  out->set_x(v.x);
  out->set_y(v.y);
  out->set_z(v.z);
}

void set_cell(wire::Cell* out, const CellId& id) {
  out->set_level(id.level);
  out->set_x(id.x);
  out->set_y(id.y);
  out->set_z(id.z);
}

void describe(wire::SceneInfo& out, const SceneDescription& scene) {
  out.set_name(scene.name);
  out.set_scene_hash(scene.hash);
  set_vec(out.mutable_origin(), scene.world_origin);
  set_vec(out.mutable_bounds_min(), scene.bounds.min);
  set_vec(out.mutable_bounds_max(), scene.bounds.max);
  set_vec(out.mutable_start(), scene.start);
  out.set_finest_side_m(scene.settings.finest_side_m);
  out.set_kappa(scene.settings.kappa);
  out.set_tau_px(scene.settings.tau_px);
  out.set_edge_samples(static_cast<std::uint32_t>(scene.settings.edge_samples()));
  out.set_background(scene.background.r | (scene.background.g << 8) | (std::uint32_t{scene.background.b} << 16));
  out.set_triangles(scene.triangles);
}

/// Exactly unrotated and unscaled, as every chunk of a mesh that stands in the scene frame.
bool is_translation(const glm::dmat4x3& m) { return glm::dmat3(m) == glm::dmat3(1); }

void place(wire::Placement& out, const CellService& service, std::uint32_t chunk, const glm::dvec3& centre) {
  const PlacedSceneChunk placed = service.chunk_placement(chunk);
  out.set_chunk(placed.hash);
  if (placed.texture >= 0) out.set_texture(service.texture(static_cast<std::uint32_t>(placed.texture)).hash);
  const glm::dvec3 translation = placed.scene_from_chunk[3] - centre;
  if (!is_translation(placed.scene_from_chunk)) {
    for (int column = 0; column < 3; ++column) {
      for (int row = 0; row < 3; ++row) out.add_transform(static_cast<float>(placed.scene_from_chunk[column][row]));
    }
  }
  for (int row = 0; row < 3; ++row) out.add_transform(static_cast<float>(translation[row]));
}

}  // namespace

OutgoingFrame welcome_message(const SessionGreeting& greeting, const ServerLimits& limits,
                              std::span<const std::shared_ptr<CellService>> catalogue, const SceneDescription& scene) {
  wire::Welcome welcome;
  welcome.set_version(greeting.version);
  welcome.set_resume_token(greeting.resume_token);
  welcome.set_resumed(greeting.resumed);
  welcome.mutable_limits()->set_frame_bytes(kFromServerLimits.frame_bytes());
  welcome.mutable_limits()->set_held(limits.held);
  welcome.mutable_limits()->set_poses_per_second(limits.poses_per_second);
  welcome.mutable_limits()->set_leaves_per_second(limits.leaves_per_second);
  for (const std::shared_ptr<CellService>& service : catalogue) {
    wire::CatalogueEntry* entry = welcome.add_catalogue();
    entry->set_name(service->scene().name);
    entry->set_triangles(service->scene().triangles);
  }
  describe(*welcome.mutable_scene(), scene);
  return make_message(MessageType::kWelcome, welcome);
}

OutgoingFrame failure_message(const Error& error, bool is_fatal) {
  wire::Failure failure;
  failure.set_code(static_cast<std::uint32_t>(error.code));
  failure.set_message(error.message);
  failure.set_fatal(is_fatal);
  return make_message(MessageType::kFailure, failure);
}

OutgoingFrame go_away_message(const std::string& reason, const std::string& resume_token,
                              std::chrono::milliseconds retry_after) {
  wire::GoAway away;
  away.set_reason(reason);
  away.set_resume_token(resume_token);
  away.set_retry_after_ms(static_cast<std::uint32_t>(retry_after.count()));
  return make_message(MessageType::kGoAway, away);
}

OutgoingFrame leaf_set_message(const LeafSetHead& head, const CellService& service, const LeafPlan& plan) {
  wire::LeafSet set;
  set.set_serial(head.serial);
  set.set_is_current(head.is_current);
  set.set_is_fallback(plan.is_fallback);
  set_cell(set.mutable_leaf(), plan.leaf);
  set_cell(set.mutable_root(), plan.root);
  set.set_background_visible(plan.background_visible);
  set.set_sky(plan.sky.bytes().data(), plan.sky.bytes().size());
  set.set_enclosure(plan.enclosure.bytes().data(), plan.enclosure.bytes().size());
  set.set_exceeds_budget(plan.exceeds_budget);
  set.set_near_triangles(plan.near_triangles);
  const ContentHash scene_hash = service.scene().hash;
  for (const NeededTile& tile : plan.tiles) set.add_tiles(tile_payload_key(scene_hash, tile.id));
  const glm::dvec3 centre = CellGrid{service.scene().settings.finest_side_m}.box(plan.leaf).center();
  for (const std::uint32_t chunk : plan.chunks) {
    place(*set.add_chunks(), service, chunk, centre);
  }
  return make_message(MessageType::kLeafSet, set);
}

OutgoingFrame leaf_set_complete_message(std::uint64_t serial) {
  wire::LeafSetComplete complete;
  complete.set_serial(serial);
  return make_message(MessageType::kLeafSetComplete, complete);
}

Result<Pose> to_pose(const wire::Pose& message, const CellGrid& grid) {
  const wire::Cell& cell = message.cell();
  const auto is_index = [&](std::int64_t index) {
    return index >= 0 && index < (std::int64_t{1} << 30) >> cell.level();
  };
  if (cell.level() > kMaxCellLevel || !is_index(cell.x()) || !is_index(cell.y()) || !is_index(cell.z())) {
    return fail(ErrorCode::kBadData, "a pose in cell {}/{}/{} of level {}, which is not on the grid", cell.x(), cell.y(),
                cell.z(), cell.level());
  }
  const CellId id{static_cast<std::uint8_t>(cell.level()), cell.x(), cell.y(), cell.z()};
  const glm::dvec3 offset(message.dx(), message.dy(), message.dz());
  // Half a side reaches the cell's border; rounding may carry a little across, anything farther is no offset.
  const bool is_near = glm::all(glm::lessThanEqual(glm::abs(offset), glm::dvec3(grid.side_m(id.level))));
  const glm::dquat rotation(message.qw(), message.qx(), message.qy(), message.qz());
  const double length = glm::length(rotation);
  if (!is_near || !std::isfinite(length) || !(length > 0)) {
    return fail(ErrorCode::kBadData, "a pose whose numbers are none: offset ({}, {}, {}) m, rotation of length {}", offset.x,
                offset.y, offset.z, length);
  }
  return Pose{grid.box(id).center() + offset, rotation / length};
}

}  // namespace farfield
