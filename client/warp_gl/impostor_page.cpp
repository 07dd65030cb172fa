// SPDX-License-Identifier: Apache-2.0
#include "client/warp_gl/impostor_page.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>

#include "client/warp_gl/tile_texels.h"

namespace farfield::client {
namespace {

// 1 MB, 16 dense tiles: shapes are many, and a page is freed only with its last tile. Indices fit 16 bits.
constexpr int kPageTexels = 1 << 18;
constexpr int kMostLayers = 64;
constexpr std::uint32_t kShortIndices = 1u << 16;
constexpr int kDenseLevels = 3;  // 128, 64, 32: more than any display the samples are meant for minifies

int layers_for(const PageShape& shape, int max_layers) {
  return std::clamp(kPageTexels / std::max(1, shape.width * shape.height), 1, std::min(kMostLayers, max_layers));
}

std::uint16_t sixteenths(float texels) {
  return static_cast<std::uint16_t>(std::lround(std::clamp(16.0f * texels, 0.0f, 65535.0f)));
}

}  // namespace

PageShape PageShape::of(const DepthMesh& mesh) {
  PageShape shape;
  shape.width = (std::max(1, mesh.width) + 31) / 32 * 32;
  shape.height = static_cast<int>(std::bit_ceil(static_cast<unsigned>(std::max(16, mesh.height))));
  if (mesh.width == kTileSamples && mesh.height == kTileSamples && !mesh.has_gaps) shape.level_count = kDenseLevels;
  return shape;
}

ImpostorPage::ImpostorPage(const PageShape& shape, int max_layers, std::uint32_t least_vertices,
                           std::uint32_t least_indices)
    : shape_(shape),
      layer_count_(layers_for(shape, max_layers)),
      // Simplified meshes have a vertex for every sixteenth sample or fewer, and some three indices per vertex.
      vertex_capacity_(
          std::max(least_vertices, static_cast<std::uint32_t>(layer_count_ * shape.width * shape.height / 16))),
      index_capacity_(std::max(least_indices, 4 * vertex_capacity_)),
      index_bytes_(vertex_capacity_ <= kShortIndices ? sizeof(std::uint16_t) : sizeof(std::uint32_t)),
      layers_(static_cast<std::uint32_t>(layer_count_)),
      vertices_(vertex_capacity_),
      indices_(index_capacity_),
      vertex_buffer_(Buffer::make(vertex_capacity_ * sizeof(ImpostorVertex))),
      index_buffer_(Buffer::make(index_capacity_ * index_bytes_)) {
  memory_bytes_ = vertex_buffer_.size_bytes() + index_buffer_.size_bytes();
  texture_ = TextureName::make();
  glBindTexture(GL_TEXTURE_2D_ARRAY, texture_.name());
  glTexStorage3D(GL_TEXTURE_2D_ARRAY, shape.level_count, GL_SRGB8_ALPHA8, shape.width, shape.height, layer_count_);
  for (int level = 0; level < shape.level_count; ++level) {
    memory_bytes_ +=
        std::size_t{4} * static_cast<std::size_t>(layer_count_ * (shape.width >> level) * (shape.height >> level));
  }
  // One level suffices between full size and half: blending two costs a third more time without a GPU.
  glTexParameteri(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_MIN_FILTER,
                  shape.level_count > 1 ? GL_LINEAR_MIPMAP_NEAREST : GL_LINEAR);
  glTexParameteri(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  glTexParameteri(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  glTexParameteri(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);

  array_ = VertexArrayName::make();
  glBindVertexArray(array_.name());
  glBindBuffer(GL_ARRAY_BUFFER, vertex_buffer_.name());
  glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, index_buffer_.name());
  const auto at = [](std::size_t offset) { return reinterpret_cast<const void*>(offset); };
  glEnableVertexAttribArray(0);
  glVertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, sizeof(ImpostorVertex), at(offsetof(ImpostorVertex, u)));
  glEnableVertexAttribArray(1);
  glVertexAttribPointer(1, 4, GL_UNSIGNED_SHORT, GL_FALSE, sizeof(ImpostorVertex),
                        at(offsetof(ImpostorVertex, column)));
  glBindVertexArray(0);
}

template <class Index>
void ImpostorPage::upload_indices(const DepthMesh& mesh, const Place& place) {
  std::vector<Index> indices(mesh.indices.size());
  std::transform(mesh.indices.begin(), mesh.indices.end(), indices.begin(),
                 [&](std::uint32_t index) { return static_cast<Index>(index + place.first_vertex); });
  index_buffer_.write(place.first_index * sizeof(Index), std::as_bytes(std::span(indices)));
}

std::optional<ImpostorPage::Place> ImpostorPage::add(const DepthMesh& mesh, std::uint16_t view) {
  Place place;
  place.vertex_count = static_cast<std::uint32_t>(mesh.vertices.size());
  place.index_count = static_cast<std::uint32_t>(mesh.indices.size());
  const auto layer = layers_.allocate(1);
  const auto vertex = layer ? vertices_.allocate(place.vertex_count) : std::nullopt;
  const auto index = vertex ? indices_.allocate(place.index_count) : std::nullopt;
  if (!index) {
    if (layer) layers_.release(*layer, 1);
    if (vertex) vertices_.release(*vertex, place.vertex_count);
    return std::nullopt;
  }
  place.layer = *layer, place.first_vertex = *vertex, place.first_index = *index;

  std::vector<ImpostorVertex> vertices;
  vertices.reserve(mesh.vertices.size());
  for (const DepthMeshVertex& v : mesh.vertices) {
    vertices.push_back({v.u, v.v, v.disparity, sixteenths(v.column), sixteenths(v.row),
                        static_cast<std::uint16_t>(place.layer), view});
  }
  vertex_buffer_.write(place.first_vertex * sizeof(ImpostorVertex), std::as_bytes(std::span(vertices)));
  if (index_bytes_ == sizeof(std::uint16_t)) {
    upload_indices<std::uint16_t>(mesh, place);
  } else {
    upload_indices<std::uint32_t>(mesh, place);
  }
  upload_texture(mesh, place.layer);
  ++tiles_;
  return place;
}

void ImpostorPage::upload_texture(const DepthMesh& mesh, std::uint32_t layer) {
  // Filtering at the edge of a texture smaller than its layer reads one texel further.
  int width = std::min(mesh.width + 1, shape_.width), height = std::min(mesh.height + 1, shape_.height);
  std::vector<std::uint32_t> texels = texels_of(mesh.rgb, mesh.cuts);
  if (width > mesh.width || height > mesh.height) texels = edge_repeated(texels, mesh.width, mesh.height, width, height);
  glBindTexture(GL_TEXTURE_2D_ARRAY, texture_.name());
  glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
  for (int level = 0;; ++level) {
    glTexSubImage3D(GL_TEXTURE_2D_ARRAY, level, 0, 0, static_cast<GLint>(layer), width, height, 1, GL_RGBA,
                    GL_UNSIGNED_BYTE, texels.data());
    if (level + 1 == shape_.level_count) return;
    texels = half_size(texels, width, height);
    width /= 2, height /= 2;
  }
}

void ImpostorPage::remove(const Place& place) {
  layers_.release(place.layer, 1);
  vertices_.release(place.first_vertex, place.vertex_count);
  indices_.release(place.first_index, place.index_count);
  --tiles_;
}

}  // namespace farfield::client
