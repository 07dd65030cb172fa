// SPDX-License-Identifier: Apache-2.0
#include "client/session/wire_convert.h"

#include <algorithm>
#include <cmath>

#include "proto/farfield.pb.h"

namespace farfield::client {
namespace {

glm::dvec3 to_vec(const wire::Vec3d& v) { return {v.x(), v.y(), v.z()}; }
bool is_finite(const glm::dvec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

Result<CellId> to_cell(const wire::Cell& cell) {
  const auto is_index = [&](std::int64_t index) { return index >= 0 && index < (std::int64_t{1} << 30) >> cell.level(); };
  if (cell.level() > kMaxCellLevel || !is_index(cell.x()) || !is_index(cell.y()) || !is_index(cell.z())) {
    return fail(ErrorCode::kBadData, "the server names cell {}/{}/{} of level {}, which is not on the grid", cell.x(),
                cell.y(), cell.z(), cell.level());
  }
  return CellId{static_cast<std::uint8_t>(cell.level()), cell.x(), cell.y(), cell.z()};
}

Result<LeafSetChunk> to_chunk(const wire::Placement& placement) {
  LeafSetChunk chunk{placement.chunk(), placement.texture()};
  const auto& numbers = placement.transform();
  const bool is_finite = std::all_of(numbers.begin(), numbers.end(), [](float v) { return std::isfinite(v); });
  if (!is_finite || (numbers.size() != 3 && numbers.size() != 12)) {
    return fail(ErrorCode::kBadData, "the server places chunk {:016x} by {} numbers that are no transform",
                chunk.chunk, numbers.size());
  }
  const int first = numbers.size() == 3 ? 3 : 0;  // three: the translation, column 3, alone
  for (int i = 0; i < numbers.size(); ++i) chunk.cell_from_chunk[first + i / 3][i % 3] = numbers[i];
  return chunk;
}

glm::vec3 offset_on_wire(const CellGrid& grid, const CellId& cell, const glm::dvec3& position) {
  return glm::vec3(position - grid.box(cell).center());
}

}  // namespace

Result<SceneDescription> to_scene_description(const wire::SceneInfo& info) {
  SceneDescription scene;
  scene.name = info.name();
  scene.scene_hash = info.scene_hash();
  scene.origin = to_vec(info.origin());
  scene.bounds = {to_vec(info.bounds_min()), to_vec(info.bounds_max())};
  scene.start = to_vec(info.start());
  scene.frame.grid.finest_side_m = info.finest_side_m();
  scene.frame.kappa = info.kappa();
  const std::uint32_t background = info.background();
  scene.frame.background = {background & 0xff, (background >> 8) & 0xff, (background >> 16) & 0xff};
  scene.tau_px = info.tau_px();
  scene.edge_samples = static_cast<int>(std::min<std::uint32_t>(info.edge_samples(), 1u << 16));
  scene.triangles = info.triangles();
  const bool has_grid = std::isfinite(info.finest_side_m()) && info.finest_side_m() > 0 && std::isfinite(info.kappa()) &&
                        info.kappa() > 0;
  if (!has_grid || !is_finite(scene.origin) || !is_finite(scene.bounds.min) || !is_finite(scene.bounds.max) ||
      !is_finite(scene.start)) {
    return fail(ErrorCode::kBadData, "the server describes scene '{}' by numbers that describe no scene", info.name());
  }
  return scene;
}

Result<LeafSet> to_leaf_set(const wire::LeafSet& message) {
  if (message.tiles_size() > kMaxLeafSetItems || message.chunks_size() > kMaxLeafSetItems) {
    return fail(ErrorCode::kLimitExceeded, "the server lists {} tiles and {} chunks for one leaf; at most {} are accepted",
                message.tiles_size(), message.chunks_size(), kMaxLeafSetItems);
  }
  const Result<CellId> leaf = to_cell(message.leaf());
  if (!leaf) return tl::unexpected(leaf.error());
  const Result<CellId> root = to_cell(message.root());
  if (!root) return tl::unexpected(root.error());
  Result<EnclosureMask> enclosure =
      EnclosureMask::from_bytes({reinterpret_cast<const std::uint8_t*>(message.enclosure().data()), message.enclosure().size()});
  if (!enclosure) return tl::unexpected(std::move(enclosure.error()));
  LeafSet set;
  set.enclosure = std::move(*enclosure);
  set.serial = message.serial();
  set.leaf = *leaf;
  set.root = *root;
  set.is_current = message.is_current();
  set.is_fallback = message.is_fallback();
  set.background_visible = message.background_visible();
  set.sky = DirectionMask::from_bytes({reinterpret_cast<const std::uint8_t*>(message.sky().data()), message.sky().size()});
  set.near_triangles = message.near_triangles();
  set.tiles.assign(message.tiles().begin(), message.tiles().end());
  set.chunks.reserve(static_cast<std::size_t>(message.chunks_size()));
  for (const wire::Placement& placement : message.chunks()) {
    const Result<LeafSetChunk> chunk = to_chunk(placement);
    if (!chunk) return tl::unexpected(chunk.error());
    set.chunks.push_back(*chunk);
  }
  return set;
}

glm::dvec3 position_on_wire(const CellGrid& grid, const glm::dvec3& position) {
  const CellId cell = grid.cell_at(position, 0);
  return grid.box(cell).center() + glm::dvec3(offset_on_wire(grid, cell, position));
}

void fill_pose(const CellGrid& grid, const Pose& pose, wire::Pose& message) {
  const CellId cell = grid.cell_at(pose.position, 0);
  message.mutable_cell()->set_level(cell.level);
  message.mutable_cell()->set_x(cell.x);
  message.mutable_cell()->set_y(cell.y);
  message.mutable_cell()->set_z(cell.z);
  const glm::vec3 offset = offset_on_wire(grid, cell, pose.position);
  message.set_dx(offset.x);
  message.set_dy(offset.y);
  message.set_dz(offset.z);
  message.set_qx(static_cast<float>(pose.world_from_camera.x));
  message.set_qy(static_cast<float>(pose.world_from_camera.y));
  message.set_qz(static_cast<float>(pose.world_from_camera.z));
  message.set_qw(static_cast<float>(pose.world_from_camera.w));
}

ErrorCode to_error_code(std::uint32_t code) {
  return code <= static_cast<std::uint32_t>(ErrorCode::kInternal) ? static_cast<ErrorCode>(code) : ErrorCode::kInternal;
}

}  // namespace farfield::client
