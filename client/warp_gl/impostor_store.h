// SPDX-License-Identifier: Apache-2.0
// Which tiles are on the GPU: uploaded within a budget per frame, evicted by bytes, least recently wanted first.
// Belongs to the context's thread.
#pragma once

#include <cstdint>
#include <list>
#include <memory>
#include <span>
#include <unordered_map>
#include <vector>

#include "client/gl/gl_context.h"
#include "client/store/leaf_view.h"
#include "client/warp_gl/impostor_page.h"
#include "client/warp_gl/view_table.h"

namespace farfield::client {

/// A tile that is ready to be drawn.
struct ResidentTile {
  ImpostorPage* page = nullptr;
  ImpostorPage::Place place;
  std::uint16_t view = 0;         // row of the view table
  glm::dvec3 middle{0}, half{0};  // bounds in (u, v, disparity)
  double side_m = 1;
  int level = 0;
  bool is_delta = false;
  std::uint64_t last_frame = 0;
};

struct UploadResult {
  bool is_complete = true;  // every tile of the leaf set is resident
  std::uint64_t uploaded_bytes = 0;
  std::uint32_t refused_tiles = 0;  // do not fit the context's limits, or are not what they claim to be
};

class ImpostorStore {
 public:
  /// `budget_bytes`: what the leaf sets in use need stays, even beyond it.
  ImpostorStore(const GlAbilities& abilities, std::size_t budget_bytes);

  /// Begins a frame: uploads missing tiles in the leaf set's order until `frame_upload_bytes` are used up (at least one tile).
  /// Tiles of `in_use`, leaf sets that this frame may draw as well, stay.
  UploadResult upload(const LeafView& leaf, std::size_t frame_upload_bytes, std::span<const std::shared_ptr<const LeafView>> in_use);
  /// Returns: null if it is not resident. Marks it as wanted.
  const ResidentTile* find(const DecodedTile& tile);
  /// Ends the frame: tiles not wanted since are evicted while the budget is exceeded.
  void evict();

  ViewTable& views() { return views_; }
  std::size_t held_bytes() const { return held_bytes_; }

 private:
  /// `keep_from`: tiles wanted by that frame or a later one stay.
  bool add(const DecodedTile& tile, std::uint64_t keep_from);
  bool is_acceptable(const DepthMesh& mesh) const;
  /// Evicts tiles last wanted before `frame`, longest unwanted first, while the budget is exceeded.
  void make_room(std::uint64_t frame);
  void erase(std::unordered_map<std::uint64_t, ResidentTile>::iterator tile);

  GlAbilities abilities_;
  std::size_t budget_bytes_;
  std::list<ImpostorPage> pages_;                          // stable addresses
  std::unordered_map<std::uint64_t, ResidentTile> tiles_;  // by serial
  ViewTable views_;
  std::size_t held_bytes_ = 0;
  std::uint64_t frame_ = 0;
};

}  // namespace farfield::client
