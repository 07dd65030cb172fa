// SPDX-License-Identifier: Apache-2.0
#include "client/warp_gl/impostor_store.h"

#include <algorithm>
#include <limits>

namespace farfield::client {
ImpostorStore::ImpostorStore(const GlAbilities& abilities, std::size_t budget_bytes)
    : abilities_(abilities), budget_bytes_(budget_bytes) {}

bool ImpostorStore::is_acceptable(const DepthMesh& mesh) const {
  // Rows are coded in sixteenths in 16 bits: 4095 is the last whole texel.
  const int most = std::min(abilities_.max_texture_edge, 4095);
  if (mesh.width < 1 || mesh.height < 1 || mesh.width > most || mesh.height > most) return false;
  const std::size_t texels = static_cast<std::size_t>(mesh.width) * static_cast<std::size_t>(mesh.height);
  if (mesh.rgb.size() != 3 * texels || mesh.cuts.size() != texels) return false;
  return std::all_of(mesh.indices.begin(), mesh.indices.end(),
                     [&](std::uint32_t index) { return index < mesh.vertices.size(); });
}

bool ImpostorStore::add(const DecodedTile& tile, std::uint64_t keep_from) {
  const DepthMesh mesh = tile.mesh.unpack();
  if (!is_acceptable(mesh)) return false;
  const auto view = views_.acquire(tile.view_position, tile.side_m, mesh.face);
  if (!view) return false;
  ResidentTile resident;
  resident.view = *view;
  resident.side_m = tile.side_m;
  resident.level = tile.id.cell.level;
  resident.is_delta = tile.id.is_delta();
  resident.last_frame = frame_;

  glm::dvec3 low(std::numeric_limits<double>::max()), high(std::numeric_limits<double>::lowest());
  for (const DepthMeshVertex& v : mesh.vertices) {
    const glm::dvec3 point(v.u, v.v, v.disparity);
    low = glm::min(low, point), high = glm::max(high, point);
  }
  resident.middle = 0.5 * (low + high), resident.half = 0.5 * (high - low);

  const PageShape shape = PageShape::of(mesh);
  std::optional<ImpostorPage::Place> place;
  for (ImpostorPage& page : pages_) {
    if (page.shape() != shape) continue;
    place = page.add(mesh, *view);
    if (place) {
      resident.page = &page;
      break;
    }
  }
  if (!place) {
    resident.page =
        &pages_.emplace_back(shape, abilities_.max_texture_layers, static_cast<std::uint32_t>(mesh.vertices.size()),
                             static_cast<std::uint32_t>(mesh.indices.size()));
    held_bytes_ += resident.page->memory_bytes();
    make_room(keep_from);
    place = resident.page->add(mesh, *view);
  }
  resident.place = *place;
  tiles_.emplace(tile.serial, resident);
  return true;
}

UploadResult ImpostorStore::upload(const LeafView& leaf, std::size_t frame_upload_bytes,
                                   std::span<const std::shared_ptr<const LeafView>> in_use) {
  UploadResult result;
  ++frame_;
  // What the last frame drew stays on the screen until all of this set is here: at once, if nothing limits the upload.
  const bool is_at_once = frame_upload_bytes == std::numeric_limits<std::size_t>::max();
  const std::uint64_t keep_from = is_at_once ? frame_ : frame_ - 1;
  // What is wanted and here already must not make room for the rest.
  for (const auto& other : in_use) {
    for (const auto& tile : other->tiles) {
      if (tile) find(*tile);
    }
  }
  for (const auto& tile : leaf.tiles) {
    if (tile) find(*tile);
  }
  for (const auto& tile : leaf.tiles) {
    if (!tile || tile->mesh.is_empty() || find(*tile)) continue;
    const std::uint64_t bytes = tile->mesh.unpacked_bytes();
    if (result.uploaded_bytes > 0 && result.uploaded_bytes + bytes > frame_upload_bytes) {
      result.is_complete = false;
      continue;  // the rest is still marked as wanted
    }
    if (add(*tile, keep_from)) {
      result.uploaded_bytes += bytes;
    } else {
      ++result.refused_tiles;
    }
  }
  return result;
}

const ResidentTile* ImpostorStore::find(const DecodedTile& tile) {
  const auto found = tiles_.find(tile.serial);
  if (found == tiles_.end()) return nullptr;
  found->second.last_frame = frame_;
  return &found->second;
}

void ImpostorStore::erase(std::unordered_map<std::uint64_t, ResidentTile>::iterator tile) {
  ImpostorPage* page = tile->second.page;
  page->remove(tile->second.place);
  views_.release(tile->second.view);
  tiles_.erase(tile);
  if (!page->is_empty()) return;
  held_bytes_ -= page->memory_bytes();
  pages_.remove_if([page](const ImpostorPage& p) { return &p == page; });
}

void ImpostorStore::evict() { make_room(frame_); }

void ImpostorStore::make_room(std::uint64_t frame) {
  if (held_bytes_ <= budget_bytes_) return;
  std::vector<std::pair<std::uint64_t, std::uint64_t>> unwanted;  // last frame, serial
  for (const auto& [serial, tile] : tiles_) {
    if (tile.last_frame < frame) unwanted.emplace_back(tile.last_frame, serial);
  }
  std::sort(unwanted.begin(), unwanted.end());
  for (const auto& [last_frame, serial] : unwanted) {
    if (held_bytes_ <= budget_bytes_) return;
    erase(tiles_.find(serial));
  }
}

}  // namespace farfield::client
