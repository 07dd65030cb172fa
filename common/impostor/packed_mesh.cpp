// SPDX-License-Identifier: Apache-2.0
#include "common/impostor/packed_mesh.h"

#include <zstd.h>

#include <cstring>
#include <new>

namespace farfield {
namespace {

constexpr int kZstdLevel = 1;

// Calls visit(first byte, count) for each vector of the mesh, in the order in which they are packed.
template <class Mesh, class Visit>
void each_array(Mesh& mesh, Visit visit) {
  visit(mesh.rgb.data(), mesh.rgb.size());
  visit(mesh.cuts.data(), mesh.cuts.size());
  visit(mesh.indices.data(), mesh.indices.size() * sizeof(mesh.indices[0]));
  visit(mesh.vertices.data(), mesh.vertices.size() * sizeof(mesh.vertices[0]));
}

}  // namespace

PackedMesh::PackedMesh(const DepthMesh& mesh)
    : face_(mesh.face),
      width_(mesh.width),
      height_(mesh.height),
      has_gaps_(mesh.has_gaps),
      sizes_{mesh.rgb.size(), mesh.cuts.size(), mesh.vertices.size(), mesh.indices.size()} {
  Bytes raw;
  each_array(mesh, [&](const void* first, std::size_t count) {
    const auto* bytes = static_cast<const std::uint8_t*>(first);
    raw.insert(raw.end(), bytes, bytes + count);
  });
  Bytes packed(ZSTD_compressBound(raw.size()));
  const std::size_t size = ZSTD_compress(packed.data(), packed.size(), raw.data(), raw.size(), kZstdLevel);
  // It fails only for want of memory, for which there is an exception already.
  if (ZSTD_isError(size)) throw std::bad_alloc();
  bytes_.assign(packed.begin(), packed.begin() + static_cast<std::ptrdiff_t>(size));
}

DepthMesh PackedMesh::unpack() const {
  DepthMesh mesh;
  mesh.face = face_, mesh.width = width_, mesh.height = height_, mesh.has_gaps = has_gaps_;
  if (bytes_.empty()) return mesh;
  mesh.rgb.resize(sizes_.rgb), mesh.cuts.resize(sizes_.cuts), mesh.vertices.resize(sizes_.vertices), mesh.indices.resize(sizes_.indices);
  std::size_t total = 0;
  each_array(mesh, [&](void*, std::size_t count) { total += count; });
  Bytes raw(total);
  const std::size_t size = ZSTD_decompress(raw.data(), raw.size(), bytes_.data(), bytes_.size());
  if (size != total) throw std::bad_alloc();
  std::size_t at = 0;
  each_array(mesh, [&](void* first, std::size_t count) {
    if (count > 0) std::memcpy(first, raw.data() + at, count);
    at += count;
  });
  return mesh;
}

std::size_t PackedMesh::unpacked_bytes() const {
  return sizes_.rgb + sizes_.cuts + sizes_.vertices * sizeof(DepthMeshVertex) + sizes_.indices * sizeof(std::uint32_t);
}

}  // namespace farfield
