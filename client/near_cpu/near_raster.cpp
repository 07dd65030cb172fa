// SPDX-License-Identifier: Apache-2.0
#include "client/near_cpu/near_raster.h"

#include <algorithm>
#include <cassert>
#include <list>
#include <unordered_map>

#include "client/near/chunks_in_view.h"
#include "client/near_cpu/raster_triangle.h"
#include "client/near_cpu/shade_pixels.h"
#include "client/warp/splat_key.h"
#include "client/warp/tile_projection.h"

namespace farfield::client {
namespace {

struct PreparedLeaf {
  ContentHash key = 0;
  NearBatches batches;
  std::size_t bytes = 0;
};

struct HeldTexture {
  explicit HeldTexture(const DecodedTexture& decoded) : texture(decoded) {}
  RasterTexture texture;
  std::uint64_t last_frame = 0;
};

}  // namespace

struct NearRaster::State {
  NearOptions options;
  std::list<PreparedLeaf> prepared;  // most recently drawn first
  std::unordered_map<std::uint64_t, HeldTexture> textures;  // by serial
  std::uint64_t frame = 0;
  // Of this frame:
  ChunksInView in_view;
  std::vector<RasterTriangle> triangles;
  float largest_disparity = 0;
  Display pixels;

  const NearBatches& prepare(const LeafView& leaf, NearStatistics& statistics);
  const RasterTexture* texture_of(const LeafView& leaf, const NearBatch& batch, NearStatistics& statistics);
  void forget_textures();
  void place(const NearBatches& batches, const BatchInView& batch, const RasterTexture* texture, const glm::dvec3& eye_from_centre,
             const glm::dmat3& pixels_from_scene);
};

const NearBatches& NearRaster::State::prepare(const LeafView& leaf, NearStatistics& statistics) {
  const ContentHash key = near_geometry_key(leaf);
  const auto known = std::find_if(prepared.begin(), prepared.end(), [&](const PreparedLeaf& p) { return p.key == key; });
  if (known != prepared.end()) {
    prepared.splice(prepared.begin(), prepared, known);
    return prepared.front().batches;
  }
  PreparedLeaf fresh{key, near_batches(leaf), 0};
  fresh.batches.vertices.shrink_to_fit(), fresh.batches.indices.shrink_to_fit();
  fresh.bytes = fresh.batches.vertices.size() * sizeof(SurfaceVertex) + fresh.batches.indices.size() * sizeof(std::uint32_t);
  statistics.uploaded_bytes += fresh.bytes;
  prepared.push_front(std::move(fresh));
  std::size_t held = 0;
  for (const PreparedLeaf& p : prepared) held += p.bytes;
  for (; held > options.geometry_budget_bytes && prepared.size() > 1; prepared.pop_back()) held -= prepared.back().bytes;
  return prepared.front().batches;
}

const RasterTexture* NearRaster::State::texture_of(const LeafView& leaf, const NearBatch& batch, NearStatistics& statistics) {
  const auto& decoded = leaf.chunks[batch.placed_chunk].texture;
  if (!decoded) return nullptr;
  const auto [at, is_new] = textures.try_emplace(decoded->serial, *decoded);
  if (is_new) statistics.uploaded_bytes += at->second.texture.memory_bytes();
  at->second.last_frame = frame;
  return at->second.texture.is_usable() ? &at->second.texture : nullptr;
}

/// Least recently drawn first, until the budget covers the rest; what this frame draws stays.
void NearRaster::State::forget_textures() {
  std::size_t held = 0;
  for (const auto& [serial, texture] : textures) held += texture.texture.memory_bytes();
  while (held > options.texture_budget_bytes) {
    const auto oldest = std::min_element(textures.begin(), textures.end(), [](const auto& a, const auto& b) { return a.second.last_frame < b.second.last_frame; });
    if (oldest->second.last_frame == frame) return;
    held -= oldest->second.texture.memory_bytes();
    textures.erase(oldest);
  }
}

void NearRaster::State::place(const NearBatches& batches, const BatchInView& batch, const RasterTexture* texture,
                              const glm::dvec3& eye_from_centre, const glm::dmat3& pixels_from_scene) {
  RasterTriangle triangle;
  triangle.texture = texture;
  triangle.is_alpha_masked = texture && batch.batch->is_alpha_masked;
  triangle.alpha_cutoff = batch.batch->alpha_cutoff;
  std::array<RasterCorner, 3> corners;
  const std::size_t end = batch.first_index + batch.index_count;
  for (std::size_t i = batch.first_index; i + 2 < end; i += 3) {
    for (std::size_t k = 0; k < 3; ++k) {
      const SurfaceVertex& vertex = batches.vertices[in_view.indices[i + k]];
      corners[k] = {pixels_from_scene * (glm::dvec3(vertex.position) - eye_from_centre), &vertex};
    }
    if (place_triangle(corners, largest_disparity, pixels.width, pixels.height, triangle)) triangles.push_back(triangle);
  }
}

NearRaster::NearRaster(const NearOptions& options) : state_(std::make_unique<State>()) { state_->options = options; }
NearRaster::~NearRaster() = default;

NearStatistics NearRaster::begin(const LeafView& leaf, const Pose& eye, const Display& pixels, double near_plane_m) {
  State& s = *state_;
  NearStatistics statistics;
  ++s.frame;
  s.pixels = pixels;
  s.largest_disparity = static_cast<float>(1 / near_plane_m);
  s.triangles.clear();
  const NearBatches& batches = s.prepare(leaf, statistics);
  const glm::dvec3 centre = leaf.leaf_box.center();
  s.in_view.find(batches.batches, batches.indices, centre, ViewTransform::of(pixels, eye, near_plane_m), statistics);
  const glm::dmat3 pixels_from_scene = pixels_from_directions(eye.world_from_camera, pixels);
  for (const BatchInView& batch : s.in_view.batches) {
    s.place(batches, batch, s.texture_of(leaf, *batch.batch, statistics), eye.position - centre, pixels_from_scene);
    ++statistics.draw_calls;
  }
  s.forget_textures();
  return statistics;
}

void NearRaster::draw_rows(const Display& pixels, int first_row, int last_row, std::uint64_t* keys) const {
  const State& s = *state_;
  assert(pixels.width == s.pixels.width && pixels.height == s.pixels.height);
  const int width = pixels.width;
  const auto row_at = [&](int y) { return keys + static_cast<std::size_t>(y) * static_cast<std::size_t>(width); };
  std::fill(row_at(first_row), row_at(last_row), kNoSplat);
  // Until colours are found a key's lower half is the triangle's number, from 1; later ones are larger.
  for (std::size_t k = 0; k < s.triangles.size(); ++k)
    draw_triangle(s.triangles[k], static_cast<std::uint32_t>(k + 1), s.largest_disparity, first_row, last_row, width, keys);
  for (int y = first_row; y < last_row; ++y) {
    std::uint64_t* row = row_at(y);
    for (int x = 0; x < width;) {
      const auto number = static_cast<std::uint32_t>(row[x]);
      int end = x + 1;
      while (end < width && static_cast<std::uint32_t>(row[end]) == number) ++end;
      if (number != 0) shade_pixels(s.triangles[number - 1], y, x, end, row);
      x = end;
    }
  }
}

}  // namespace farfield::client
