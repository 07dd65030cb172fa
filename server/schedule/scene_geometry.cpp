// SPDX-License-Identifier: Apache-2.0
#include "server/schedule/scene_geometry.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <unordered_map>
#include <utility>
#include <vector>

namespace farfield {
namespace {

class SceneGeometry final : public GeometrySource {
 public:
  explicit SceneGeometry(std::shared_ptr<const Scene> scene) : scene_(std::move(scene)) {
    std::uint32_t stored = 0;
    for (const SceneChunk& chunk : scene_->chunks()) stored = std::max(stored, chunk.stored_chunk + 1);
    texture_of_ = std::vector<std::atomic<int>>(stored);
    for (auto& texture : texture_of_) texture.store(kUnknown, std::memory_order_relaxed);
    int index = 0;
    for (const Scene::TextureInfo& texture : scene_->textures()) texture_index_.emplace(texture.hash, index++);
  }

  std::size_t chunk_count() const override { return scene_->chunks().size(); }
  std::size_t texture_count() const override { return scene_->textures().size(); }

  PlacedSceneChunk placement(std::uint32_t index) const override {
    const SceneChunk& chunk = scene_->chunks()[index];
    // Two threads may both find out; they find the same.
    std::atomic<int>& known = texture_of_[chunk.stored_chunk];
    int texture = known.load(std::memory_order_relaxed);
    if (texture == kUnknown) {
      const auto found = texture_index_.find(scene_->chunk_geometry(index).texture);
      texture = found == texture_index_.end() ? -1 : found->second;
      known.store(texture, std::memory_order_relaxed);
    }
    return {.hash = chunk.hash, .texture = texture, .bounds = chunk.bounds, .scene_from_chunk = chunk.scene_from_chunk};
  }

  SceneTexture texture(std::uint32_t texture) const override {
    const Scene::TextureInfo& info = scene_->textures()[texture];
    return {.hash = info.hash, .width = info.width, .height = info.height, .level_count = info.level_count};
  }

  SharedBytes chunk(std::uint32_t chunk) const override { return scene_->encoded_chunk(chunk); }
  SharedBytes texture_level(std::uint32_t texture, int level) const override {
    return scene_->encoded_texture_level(texture, level);
  }

 private:
  static constexpr int kUnknown = -2;

  std::shared_ptr<const Scene> scene_;
  std::unordered_map<ContentHash, int> texture_index_;
  mutable std::vector<std::atomic<int>> texture_of_;  // by stored chunk: index, -1 none, or kUnknown
};

}  // namespace

std::shared_ptr<const GeometrySource> scene_geometry(std::shared_ptr<const Scene> scene) {
  return std::make_shared<const SceneGeometry>(std::move(scene));
}

SceneDescription describe_scene(const Scene& scene, const ImpostorSettings& settings, const glm::dvec3& start) {
  const std::array<ContentHash, 2> parts{scene.hash(), settings.hash()};
  return {.name = scene.name(),
          .hash = hash_values(std::span<const ContentHash>(parts)),
          .world_origin = scene.origin(),
          .bounds = scene.bounds(),
          .settings = settings,
          .background = scene.background(),
          .start = start,
          .triangles = scene.statistics().drawn_triangles};
}

}  // namespace farfield
