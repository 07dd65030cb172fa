// SPDX-License-Identifier: Apache-2.0
// The model made ready: triangles, materials, ray-tracing structure and chunks. Immutable; safe from any thread.
//
// Scene frame: metres relative to `origin()`, the world position chosen at load, so that float rays and the cell grid
// are as exact at 10⁷ m as at 0. Everything below speaks scene frame unless it says world.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "common/base/memory_image.h"
#include "common/base/result.h"
#include "common/geometry/chunk.h"
#include "common/math/box.h"
#include "server/model/model.h"
#include "server/scene/ray_packet.h"

namespace farfield {

/// A stored mesh and where it stands. Meshes used once, and small ones, are flattened: all triangles of one texture
/// and mask become one stored mesh in the scene frame, whose transform is the identity. Larger meshes placed more than
/// once are stored once, each placement being a part.
struct ScenePart {
  std::uint32_t mesh = 0;                 // index into the scene's stored meshes
  glm::mat4x3 scene_from_mesh{1};
  Box bounds;
};

/// One placed chunk as near geometry sees it.
struct SceneChunk {
  ContentHash hash = 0;                   // of its content (vertices, indices, texture, mask), not of its encoded bytes:
                                          // the same for all placements of an instanced mesh
  std::uint32_t part = 0;
  std::uint32_t stored_chunk = 0;         // index for encoded_chunk()
  std::uint32_t triangles = 0;
  Box bounds;
  glm::vec3 cone_axis{0, 0, 1};           // normal cone: every triangle normal n has dot(n, axis) >= cone_cos
  float cone_cos = -1;                    // -1: no useful cone
  glm::dmat4x3 scene_from_chunk{1};       // chunk-relative metres to scene frame
};

struct SceneStatistics {
  std::size_t drawn_triangles = 0, stored_triangles = 0, parts = 0, chunks = 0, textures = 0, materials = 0;
  double build_seconds = 0;
};

class Scene {
 public:
  /// Takes the model's meshes over. Cost: O(n log n), on all TBB workers of the calling arena. Positions are snapped to
  /// a power-of-two grid (scene_frame.h) and uvs to 2⁻¹⁸, so that chunks encode without loss and rays meet exactly
  /// what the client draws. Triangles without area on that grid, or with non-finite vertices, are left out.
  /// Errors: kBadData (an index or array size of the model that does not fit, or nothing to draw).
  static Result<std::shared_ptr<const Scene>> build(Model model);
  /// Everything but the ray-tracing structure, as it is in memory: for restore() in the same build of Farfield.
  void write(MemoryImageWriter& out) const;
  /// Takes a written scene back, bit for bit; the ray-tracing structure is built meanwhile, and queries of rays wait for it (and throw
  /// std::runtime_error if it cannot be built). O(bytes). Any bytes are safe. Errors: kBadData.
  static Result<std::shared_ptr<const Scene>> restore(MemoryImageReader& in);
  ~Scene();

  const std::string& name() const;
  const glm::dvec3& origin() const;           // world position of the scene frame's zero
  const Box& bounds() const;                  // scene frame
  ContentHash hash() const;                   // of geometry, materials and textures in the scene frame (a scene moved
                                              // with its origin keeps it): part of every cache key
  const SceneStatistics& statistics() const;
  glm::u8vec3 background() const;             // sRGB
  std::span<const ScenePart> parts() const;
  bool is_textured(std::uint32_t part) const;  // else its colours come from its vertices alone

  // ── rays ──
  /// First hits of sixteen coherent rays. Alpha-masked texels let rays through. Closed surfaces are tight along edges;
  /// of rays aimed at the very point of a vertex four in a thousand may slip through (tests/stability/leak_stress.cpp).
  void intersect(const RayPacket& rays, HitPacket& hits) const;
  /// The same without the coherent flag, for scattered rays.
  void intersect_scattered(const RayPacket& rays, HitPacket& hits) const;
  /// Bit i set: something lies between near and far on ray i.
  std::uint32_t occluded(const RayPacket& rays) const;
  /// The same for rays that stay close together: a packet's way to the closest hits is shorter than its rays' own to any.
  std::uint32_t occluded_coherent(const RayPacket& rays) const;

  // ── shading ──
  /// Linear radiance of the active lanes that hit. `pixel_angle`: the tangent of the angle one sample covers, so its footprint is
  /// pixel_angle × distance (for directions of any length: × |direction|), widened by the surface's inclination.
  /// Writes rgb[3·lane + channel]; lanes without a hit are untouched.
  void shade(const RayPacket& rays, const HitPacket& hits, float pixel_angle, float* rgb) const;
  /// The same with the mean of 2×2 texture look-ups around each hit, each of half the footprint: what fine texture and
  /// texture seen at a slant need. `across`, `down`: the change of a ray's direction from one look-up to the next.
  void shade_finely(const RayPacket& rays, const HitPacket& hits, float pixel_angle, const glm::vec3& across, const glm::vec3& down,
                    float* rgb) const;

  // ── chunks ──
  std::span<const SceneChunk> chunks() const;
  /// Index into chunks() of the chunk that holds this triangle of this part: the item buffer's key.
  std::uint32_t chunk_of(std::uint32_t part, std::uint32_t primitive) const;
  /// Indices of the chunks whose bounds meet `box`; O(log n + result).
  std::vector<std::uint32_t> chunks_in(const Box& box) const;
  /// Encoded bytes of a chunk (made at build or on first use, cached, thread-safe).
  SharedBytes encoded_chunk(std::uint32_t chunk) const;
  /// The decoded form, for renderers on this side (truth, baselines).
  Chunk chunk_geometry(std::uint32_t chunk) const;

  // ── textures ──
  struct TextureInfo {
    ContentHash hash = 0;
    int width = 0, height = 0, level_count = 0;
  };
  std::span<const TextureInfo> textures() const;
  TextureLevel texture_level(std::uint32_t texture, int level) const;
  SharedBytes encoded_texture_level(std::uint32_t texture, int level) const;

 private:
  Scene();
  struct FineLookups;
  void shade(const RayPacket& rays, const HitPacket& hits, float pixel_angle, const FineLookups* fine, float* rgb) const;
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace farfield
