// SPDX-License-Identifier: Apache-2.0
// A tile's depth mesh and texture while nobody looks at it: the GL renderer needs them only to upload, and a client holds
// some thousand of them.
#pragma once

#include <cstddef>
#include <cstdint>

#include "common/base/bytes.h"
#include "common/impostor/depth_mesh.h"

namespace farfield {

/// Immutable. zstd: delta tiles are mostly gaps, and meshes repeat themselves. A third of the bytes, in streets and among
/// statues.
class PackedMesh {
 public:
  PackedMesh() = default;  // of an empty mesh
  /// 0.2 GB/s of the unpacked bytes, measured on tiles of generated scenes.
  explicit PackedMesh(const DepthMesh& mesh);

  bool is_empty() const { return sizes_.indices == 0; }  // nothing to draw
  /// The same mesh, bit for bit. 0.5 GB/s.
  DepthMesh unpack() const;
  /// Of the mesh unpacked, what is uploaded: texels with their cuts, vertices and indices.
  std::size_t unpacked_bytes() const;
  std::size_t memory_bytes() const { return bytes_.capacity(); }  // on the heap

 private:
  struct Sizes {
    std::size_t rgb = 0, cuts = 0, vertices = 0, indices = 0;  // of the vectors
  };
  int face_ = 0, width_ = 0, height_ = 0;
  bool has_gaps_ = false;
  Sizes sizes_;
  Bytes bytes_;
};

}  // namespace farfield
