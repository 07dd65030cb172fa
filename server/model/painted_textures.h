// SPDX-License-Identifier: Apache-2.0
// Textures painted by formula for generated scenes. All repeat without a seam and have power-of-two edges.
// The comment beside each names how much surface one repetition is meant to cover.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>

#include "server/model/model.h"

namespace farfield {

enum class WindowStyle { kSash, kWide, kNarrow, kBand };

/// 4 × 4 windows, 3 m each way.
struct FacadeStyle {
  glm::vec3 wall{0.8f};      // sRGB, 0 … 1
  glm::vec3 trim{0.9f};      // window surrounds and frames
  WindowStyle window = WindowStyle::kSash;
  bool is_brick = false;
};
TextureImage paint_facade(const FacadeStyle& style, std::uint64_t seed);
TextureImage paint_shop_fronts(std::uint64_t seed);                                          // 4 shops, 16 × 4 m
/// Any surface; 4 m. `grain`: strength of its finest noise.
TextureImage paint_rough(const char* name, glm::vec3 low, glm::vec3 high, std::uint64_t seed, float grain = 0.36f);
TextureImage paint_grass(std::uint64_t seed);                                                // 4 m
TextureImage paint_paving(glm::vec3 stone, int stones_per_edge, std::uint64_t seed);         // 4 m
TextureImage paint_bricks(glm::vec3 brick, std::uint64_t seed);                              // 2 m
TextureImage paint_roof_tiles(glm::vec3 tile, std::uint64_t seed);                           // 4 m
TextureImage paint_checker_plate(std::uint64_t seed);                                        // 0.5 m
TextureImage paint_grating(std::uint64_t seed);                                              // 0.5 m
TextureImage paint_wood(glm::vec3 wood, int boards, std::uint64_t seed);                     // 2 m
TextureImage paint_wallpaper(glm::vec3 ground, glm::vec3 figure, std::uint64_t seed);        // 1 m
TextureImage paint_carpet(glm::vec3 ground, glm::vec3 figure, std::uint64_t seed);           // 2 m
TextureImage paint_leaves(glm::vec3 leaf, std::uint64_t seed);                               // one card, alpha-masked

}  // namespace farfield
