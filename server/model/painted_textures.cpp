// SPDX-License-Identifier: Apache-2.0
#include "server/model/painted_textures.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "server/model/noise_tile.h"

namespace farfield {
namespace {

constexpr float kPi = 3.14159265359f;

// paint(u, v) -> (r, g, b, a) in 0 … 1 at texel centres, v downwards.
template <class Painter>
TextureImage painted(const char* name, int width, int height, Painter&& paint) {
  TextureImage image;
  image.name = name;
  image.width = width;
  image.height = height;
  image.rgba.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * 4);
  std::uint8_t* out = image.rgba.data();
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x, out += 4) {
      const glm::vec4 c = paint((x + 0.5f) / static_cast<float>(width), (y + 0.5f) / static_cast<float>(height));
      for (int k = 0; k < 4; ++k) out[k] = static_cast<std::uint8_t>(std::clamp(c[k], 0.0f, 1.0f) * 255.0f + 0.5f);
    }
  }
  return image;
}

glm::vec4 opaque(const glm::vec3& c) { return {c, 1.0f}; }
float fraction(float x) { return x - std::floor(x); }
/// Repeatable number in [0, 1) for a cell of a pattern.
float cell_noise(std::uint64_t seed, int x, int y) { return static_cast<float>(RandomStream(seed, x, y).unit()); }

struct BrickAt {
  float mortar;  // 1 in the joint, 0 in the brick
  int column, row;
};
BrickAt brick_at(float u, float v, int columns, int rows, float joint) {
  const float y = v * static_cast<float>(rows);
  const int row = static_cast<int>(y);
  const float x = u * static_cast<float>(columns) + (row % 2 ? 0.5f : 0.0f);
  const int column = static_cast<int>(x) % columns;
  const float fx = fraction(x), fy = fraction(y);
  const float aspect = static_cast<float>(rows) / static_cast<float>(columns);
  const bool in_joint = fy < joint || fx * aspect < joint;
  return {in_joint ? 1.0f : 0.0f, column, row};
}

}  // namespace

TextureImage paint_facade(const FacadeStyle& style, std::uint64_t seed) {
  const NoiseTile noise(seed);
  const glm::vec2 size = style.window == WindowStyle::kSash     ? glm::vec2(0.42f, 0.56f)
                         : style.window == WindowStyle::kWide   ? glm::vec2(0.70f, 0.50f)
                         : style.window == WindowStyle::kNarrow ? glm::vec2(0.32f, 0.66f)
                                                                : glm::vec2(1.20f, 0.52f);
  return painted("facade", 512, 512, [&](float u, float v) {
    const int column = static_cast<int>(u * 4), row = static_cast<int>(v * 4);
    const glm::vec2 p{fraction(u * 4) - 0.5f, fraction(v * 4) - 0.47f};
    const glm::vec2 inside = 0.5f * size - glm::abs(p);  // > 0 inside the opening, in window bays
    const float edge = std::min(inside.x, inside.y);
    const float grain = noise.at(u * 3, v * 3);
    glm::vec3 wall = style.wall * (0.86f + 0.22f * grain);
    if (style.is_brick) {
      const BrickAt brick = brick_at(u, v, 48, 128, 0.14f);
      wall = brick.mortar > 0 ? glm::vec3(0.72f, 0.69f, 0.64f) * (0.85f + 0.2f * grain)
                              : style.wall * (0.78f + 0.3f * cell_noise(seed, brick.column, brick.row) + 0.1f * grain);
    }
    wall *= 1.0f - 0.12f * glm::smoothstep(0.0f, 0.5f, noise.at(u, v * 0.25) - 0.35f);  // weather streaks
    if (edge < 0) {
      const bool is_surround = inside.x > -0.045f && inside.y > -0.045f;
      const bool is_sill = p.y > 0 && inside.y > -0.07f && inside.x > -0.07f && inside.y < 0;
      if (is_sill) return opaque(style.trim * 0.82f);
      if (is_surround) return opaque(style.trim * (0.92f + 0.08f * grain));
      const bool is_string_course = fraction(v * 4) > 0.965f;
      return opaque(is_string_course ? style.trim * 0.88f : wall);
    }
    const bool is_bar = std::abs(p.x) < 0.012f || (style.window == WindowStyle::kBand && fraction(p.x * 4) < 0.06f) ||
                        (style.window != WindowStyle::kWide && std::abs(p.y + 0.1f) < 0.012f);
    if (edge < 0.022f || is_bar) return opaque(style.trim * (edge < 0.008f ? 0.55f : 0.97f));
    // Glass: sky reflected towards the top, a room behind, in some windows a curtain or a lamp.
    const float kind = cell_noise(seed + 7, column, row);
    const float top = 0.5f - p.y / size.y;
    glm::vec3 glass = glm::mix(glm::vec3(0.10f, 0.13f, 0.17f), glm::vec3(0.40f, 0.52f, 0.62f),
                               0.75f * top * top + 0.18f * static_cast<float>(noise.at(u * 2 + 0.3, v * 2)));
    if (kind < 0.35f && std::abs(p.x) > 0.22f * size.x) {
      glass = glm::vec3(0.78f, 0.74f, 0.66f) * (0.8f + 0.2f * std::sin(p.x * 160.0f));
    } else if (kind > 0.86f) {
      glass = glm::mix(glass, glm::vec3(0.95f, 0.80f, 0.50f), 0.55f);
    } else if (kind > 0.72f && top > 0.55f) {
      glass = glm::vec3(0.80f, 0.79f, 0.75f) * (0.88f + 0.12f * std::sin(p.y * 260.0f));  // a blind half down
    }
    return opaque(glass);
  });
}

TextureImage paint_shop_fronts(std::uint64_t seed) {
  const NoiseTile noise(seed);
  static constexpr glm::vec3 kSigns[4] = {{0.55f, 0.14f, 0.12f}, {0.10f, 0.25f, 0.42f}, {0.13f, 0.36f, 0.22f},
                                          {0.62f, 0.47f, 0.16f}};
  return painted("shop fronts", 1024, 256, [&](float u, float v) {
    const int shop = static_cast<int>(u * 4);
    const float x = fraction(u * 4);
    const float grain = noise.at(u * 4, v);
    if (v < 0.22f) {  // the sign with its lettering as light strokes
      const bool is_letter = v > 0.07f && v < 0.16f && x > 0.2f && x < 0.8f &&
                             cell_noise(seed, static_cast<int>(u * 240), static_cast<int>(v * 60)) > 0.45f;
      return opaque(is_letter ? glm::vec3(0.95f, 0.92f, 0.8f) : kSigns[shop] * (0.9f + 0.2f * grain));
    }
    if (x < 0.05f || x > 0.95f || v > 0.90f) return opaque(glm::vec3(0.45f, 0.43f, 0.40f) * (0.8f + 0.4f * grain));
    const bool is_door = x > 0.68f;
    const float frame_x = is_door ? std::min(x - 0.68f, 0.95f - x) : std::min(x - 0.05f, 0.68f - x);
    if (frame_x < 0.014f || v < 0.26f || (is_door && v > 0.74f)) return opaque(kSigns[shop] * 0.75f);
    const bool has_goods = !is_door && v > 0.62f && cell_noise(seed + 3, static_cast<int>(u * 64), static_cast<int>(v * 16)) > 0.4f;
    if (has_goods) {
      const float hue = cell_noise(seed + 4, static_cast<int>(u * 64), static_cast<int>(v * 16));
      return opaque(glm::vec3(0.3f + 0.5f * hue, 0.55f - 0.3f * hue, 0.25f + 0.3f * fraction(hue * 7)));
    }
    return opaque(glm::mix(glm::vec3(0.36f, 0.43f, 0.47f), glm::vec3(0.12f, 0.13f, 0.14f), v) * (0.85f + 0.3f * grain));
  });
}

TextureImage paint_rough(const char* name, glm::vec3 low, glm::vec3 high, std::uint64_t seed, float grain) {
  const NoiseTile coarse(seed, 4), fine(seed + 1, 64);
  return painted(name, 512, 512, [&](float u, float v) {
    return opaque(glm::mix(low, high, glm::smoothstep(0.2f, 0.8f, coarse.at(u, v))) * (1 + grain * (fine.at(u * 2, v * 2) - 0.5f)));
  });
}

TextureImage paint_grass(std::uint64_t seed) {
  const NoiseTile coarse(seed, 4), fine(seed + 1, 64);
  return painted("grass", 512, 512, [&](float u, float v) {
    const float patch = coarse.at(u, v), blade = fine.at(u * 2, v * 1 + 0.2 * patch);
    const glm::vec3 c = glm::mix(glm::vec3(0.20f, 0.34f, 0.12f), glm::vec3(0.42f, 0.54f, 0.20f), patch);
    return opaque(c * (0.55f + 0.9f * blade));
  });
}

TextureImage paint_paving(glm::vec3 stone, int stones_per_edge, std::uint64_t seed) {
  const NoiseTile noise(seed);
  return painted("paving", 512, 512, [&](float u, float v) {
    const BrickAt slab = brick_at(u, v, stones_per_edge, stones_per_edge, 0.035f);
    const float grain = noise.at(u * 4, v * 4);
    if (slab.mortar > 0) return opaque(stone * 0.62f * (0.85f + 0.3f * grain));
    return opaque(stone * (0.82f + 0.16f * cell_noise(seed, slab.column, slab.row) + 0.16f * grain));
  });
}

TextureImage paint_bricks(glm::vec3 brick, std::uint64_t seed) {
  const NoiseTile noise(seed);
  return painted("bricks", 512, 512, [&](float u, float v) {
    const BrickAt at = brick_at(u, v, 8, 24, 0.12f);
    const float grain = noise.at(u * 4, v * 4);
    if (at.mortar > 0) return opaque(glm::vec3(0.70f, 0.67f, 0.62f) * (0.8f + 0.3f * grain));
    return opaque(brick * (0.70f + 0.35f * cell_noise(seed, at.column, at.row) + 0.2f * grain));
  });
}

TextureImage paint_roof_tiles(glm::vec3 tile, std::uint64_t seed) {
  const NoiseTile noise(seed);
  return painted("roof tiles", 512, 512, [&](float u, float v) {
    const BrickAt at = brick_at(u, v, 16, 16, 0.0f);
    const float x = fraction(u * 16 + (at.row % 2 ? 0.5f : 0.0f)), y = fraction(v * 16);
    const float round = 0.55f + 0.45f * std::sin(kPi * x);
    const float overlap = 1.0f - 0.45f * glm::smoothstep(0.80f, 1.0f, y);
    return opaque(tile * round * overlap * (0.8f + 0.25f * cell_noise(seed, at.column, at.row) + 0.25f * noise.at(u * 2, v * 2)));
  });
}

TextureImage paint_checker_plate(std::uint64_t seed) {
  const NoiseTile noise(seed);
  return painted("checker plate", 256, 256, [&](float u, float v) {
    const float x = u * 8, y = v * 8;
    const bool leans = (static_cast<int>(x) + static_cast<int>(y)) % 2 == 0;
    const glm::vec2 p{fraction(x) - 0.5f, fraction(y) - 0.5f};
    const glm::vec2 q = leans ? glm::vec2(p.x + p.y, p.x - p.y) : glm::vec2(p.x - p.y, p.x + p.y);
    const float lug = 1.0f - glm::smoothstep(0.7f, 1.0f, (q.x * q.x) / 0.30f + (q.y * q.y) / 0.02f);
    const float grain = noise.at(u, v);
    return opaque(glm::mix(glm::vec3(0.50f, 0.52f, 0.54f), glm::vec3(0.72f, 0.74f, 0.75f), lug) * (0.75f + 0.4f * grain));
  });
}

TextureImage paint_grating(std::uint64_t seed) {
  const NoiseTile noise(seed);
  return painted("grating", 256, 256, [&](float u, float v) {
    const float x = fraction(u * 16), y = fraction(v * 4);  // bearing bars every 31 mm, cross bars every 125 mm
    const float bar = 1.0f - glm::smoothstep(0.14f, 0.22f, std::abs(x - 0.5f)), cross = 1.0f - glm::smoothstep(0.03f, 0.05f, std::abs(y - 0.5f));
    const float metal = std::max(bar, 0.85f * cross);
    return opaque(glm::mix(glm::vec3(0.16f, 0.17f, 0.18f), glm::vec3(0.66f, 0.68f, 0.70f), metal) * (0.8f + 0.35f * noise.at(u, v)));
  });
}

TextureImage paint_wood(glm::vec3 wood, int boards, std::uint64_t seed) {
  const NoiseTile noise(seed, 4);
  return painted("wood", 512, 512, [&](float u, float v) {
    const int board = static_cast<int>(v * static_cast<float>(boards));
    const float across = fraction(v * static_cast<float>(boards));
    const float shade = cell_noise(seed, board, 0);
    const float shift = 7.3f * shade;
    const float grain = noise.at(u + shift, v * 6 + shift);
    const float rings = 0.5f + 0.5f * std::sin(40.0f * (0.35f * across + noise.at(u * 0.5 + shift, v + shift)));
    const float joint = across < 0.02f ? 0.55f : 1.0f;
    return opaque(wood * joint * (0.74f + 0.18f * shade + 0.14f * rings + 0.18f * grain));
  });
}

TextureImage paint_wallpaper(glm::vec3 ground, glm::vec3 figure, std::uint64_t seed) {
  const NoiseTile noise(seed);
  return painted("wallpaper", 512, 512, [&](float u, float v) {
    const float x = u * 4, y = v * 4 + (static_cast<int>(x) % 2 ? 0.5f : 0.0f);
    const glm::vec2 p{fraction(x) - 0.5f, fraction(y) - 0.5f};
    const float angle = std::atan2(p.y, p.x), radius = glm::length(p);
    const bool is_flower = radius < 0.20f + 0.09f * std::cos(5 * angle) && radius > 0.05f;
    const bool is_stripe = std::abs(fraction(x) - 0.02f) < 0.02f;
    const glm::vec3 c = is_flower ? figure : (is_stripe ? glm::mix(ground, figure, 0.5f) : ground);
    return opaque(c * (0.93f + 0.12f * noise.at(u * 4, v * 4)));
  });
}

TextureImage paint_carpet(glm::vec3 ground, glm::vec3 figure, std::uint64_t seed) {
  const NoiseTile noise(seed, 32);
  return painted("carpet", 512, 512, [&](float u, float v) {
    const float diamond = std::abs(fraction(u * 4) - 0.5f) + std::abs(fraction(v * 4) - 0.5f);
    const bool is_figure = (diamond > 0.42f && diamond < 0.50f) || diamond < 0.12f;
    return opaque((is_figure ? figure : ground) * (0.72f + 0.5f * noise.at(u * 3, v * 3)));
  });
}

TextureImage paint_leaves(glm::vec3 leaf, std::uint64_t seed) {
  struct Leaf {
    glm::vec2 center, axis;
    float length, shade;
  };
  RandomStream random(seed);
  std::vector<Leaf> leaves(110);
  for (Leaf& l : leaves) {
    const float angle = random.between(0.0f, 2 * kPi), reach = 0.40f * std::sqrt(random.between(0.0f, 1.0f));
    const float turn = angle + random.between(-0.9f, 0.9f);
    l = {{0.5f + reach * std::cos(angle), 0.5f + reach * std::sin(angle)}, {std::cos(turn), std::sin(turn)},
         random.between(0.05f, 0.085f), random.between(0.65f, 1.2f)};
  }
  // Painted back to front by list order; texels between leaves keep a leaf colour so that filtering leaves no dark rim.
  return painted("leaves", 256, 256, [&](float u, float v) {
    glm::vec4 colour{leaf * 0.8f, 0.0f};
    for (const Leaf& l : leaves) {
      const glm::vec2 p = glm::vec2(u, v) - l.center;
      const float along = glm::dot(p, l.axis) / l.length, across = (p.x * l.axis.y - p.y * l.axis.x) / l.length;
      if (std::abs(along) > 1 || std::abs(across) > 0.5f * (1 - along * along)) continue;
      const float vein = std::abs(across) < 0.04f ? 1.15f : 1.0f;
      colour = opaque(leaf * l.shade * vein * (0.9f + 0.15f * along));
    }
    return colour;
  });
}

}  // namespace farfield
