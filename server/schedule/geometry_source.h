// SPDX-License-Identifier: Apache-2.0
// Near geometry as the schedule sees it: encoded chunks and textures by index. Lets the service be tested without a
// scene, and hides the scene's own types from sessions.
#pragma once

#include <cstddef>
#include <cstdint>

#include "common/base/bytes.h"
#include "server/schedule/cell_service.h"

namespace farfield {

/// Thread-safe. Indices must be below the counts.
class GeometrySource {
 public:
  virtual ~GeometrySource() = default;
  virtual std::size_t chunk_count() const = 0;
  virtual std::size_t texture_count() const = 0;
  virtual PlacedSceneChunk placement(std::uint32_t chunk) const = 0;
  virtual SceneTexture texture(std::uint32_t texture) const = 0;
  /// Encodes on the calling thread the first time. Never null.
  virtual SharedBytes chunk(std::uint32_t chunk) const = 0;
  /// Requires: 0 <= level < level_count.
  virtual SharedBytes texture_level(std::uint32_t texture, int level) const = 0;
};

}  // namespace farfield
