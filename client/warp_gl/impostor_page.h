// SPDX-License-Identifier: Apache-2.0
// GPU storage that many tiles share, so that all of them are drawn with one call: a vertex buffer, an index buffer,
// and a texture array with one layer per tile. Belongs to the context's thread.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "client/gl/buffer.h"
#include "client/warp_gl/range_allocator.h"
#include "common/impostor/depth_mesh.h"

namespace farfield::client {

/// As the vertex shader reads it.
struct ImpostorVertex {
  float u = 0, v = 0, disparity = 0;
  std::uint16_t column = 0, row = 0;  // sixteenths of a texel: cuts end at eighths plus a half
  std::uint16_t layer = 0;
  std::uint16_t view = 0;  // row of the view table
};
static_assert(sizeof(ImpostorVertex) == 20);

/// What a page's layers look like. Tiles of one shape share pages.
struct PageShape {
  int width = 0, height = 0;  // texels of a layer
  int level_count = 1;        // of its mip chain
  auto operator<=>(const PageShape&) const = default;

  /// Layers just large enough: widths in steps of 32, heights in powers of two. Only square dense tiles get mips:
  /// blocks of packed ones are strangers to their neighbours in the image.
  static PageShape of(const DepthMesh& mesh);
};

class ImpostorPage {
 public:
  /// Where a tile lives in the page.
  struct Place {
    std::uint32_t layer = 0;
    std::uint32_t first_vertex = 0, vertex_count = 0;
    std::uint32_t first_index = 0, index_count = 0;
  };

  /// Room for a megabyte of texels, and for `least_vertices`, `least_indices` in any case.
  ImpostorPage(const PageShape& shape, int max_layers, std::uint32_t least_vertices, std::uint32_t least_indices);

  /// Uploads a tile's mesh and texture. Returns: nothing if there is no room for it here.
  /// Requires: PageShape::of(mesh) == shape(); mesh indices in range.
  std::optional<Place> add(const DepthMesh& mesh, std::uint16_t view);
  void remove(const Place& place);
  bool is_empty() const { return tiles_ == 0; }

  const PageShape& shape() const { return shape_; }
  std::size_t memory_bytes() const { return memory_bytes_; }
  /// 2 or 4: as many as naming every vertex of the page takes.
  std::size_t index_bytes() const { return index_bytes_; }
  GlName texture() const { return texture_.name(); }
  GlName vertex_array() const { return array_.name(); }

 private:
  template <class Index>
  void upload_indices(const DepthMesh& mesh, const Place& place);
  void upload_texture(const DepthMesh& mesh, std::uint32_t layer);

  PageShape shape_;
  int layer_count_;
  std::uint32_t vertex_capacity_, index_capacity_;
  std::size_t index_bytes_;
  RangeAllocator layers_, vertices_, indices_;
  Buffer vertex_buffer_, index_buffer_;
  VertexArrayName array_;
  TextureName texture_;
  std::size_t memory_bytes_ = 0;
  int tiles_ = 0;
};

}  // namespace farfield::client
