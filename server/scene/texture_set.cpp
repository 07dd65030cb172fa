// SPDX-License-Identifier: Apache-2.0
#include "server/scene/texture_set.h"

#ifdef __SSE4_1__
#  include <immintrin.h>
#endif

#include <algorithm>
#include <cmath>
#include <cstring>

#include "common/shading/shading.h"

namespace farfield {
namespace {

// Four lanes side by side: the channels of a texel, or the coordinates of two levels.
typedef std::uint16_t U16x4 __attribute__((vector_size(8)));
typedef std::int32_t I32x4 __attribute__((vector_size(16)));
typedef float F32x4 __attribute__((vector_size(16)));

// Two texels side by side.
typedef float F32x8 __attribute__((vector_size(32)));

constexpr float kLinearScale = 65535.0f;

// Four channels at once. GCC 12 takes __builtin_convertvector of 16-bit lanes apart, so it is spelt out where it can
// be.
F32x4 to_floats(const void* texel) {
#ifdef __SSE4_1__
  return F32x4(_mm_cvtepi32_ps(_mm_cvtepu16_epi32(_mm_loadl_epi64(static_cast<const __m128i*>(texel)))));
#else
  U16x4 channels;
  std::memcpy(&channels, texel, sizeof channels);
  return __builtin_convertvector(channels, F32x4);
#endif
}

// Two texels one after the other in memory.
void load_pair(const void* texels, F32x8& pair) {
#ifdef __AVX2__
  pair = F32x8(_mm256_cvtepi32_ps(_mm256_cvtepu16_epi32(_mm_loadu_si128(static_cast<const __m128i*>(texels)))));
#else
  const F32x4 two[2] = {to_floats(texels), to_floats(static_cast<const char*>(texels) + 8)};
  std::memcpy(&pair, two, sizeof pair);
#endif
}

}  // namespace

// The texels around a point in two levels at once: lanes are u and v in the first, u and v in the second.
struct TextureSet::Lookup {
  I32x4 first, second;  // texel columns and rows, wrapped
  F32x4 fraction;       // how far the point lies from first towards second

  Lookup(const Level& a, const Level& b, const glm::vec2& uv) {
    const float u = uv.x - std::floor(uv.x), v = uv.y - std::floor(uv.y);
    const I32x4 size{a.width, a.height, b.width, b.height};
    const F32x4 at = F32x4{u, v, u, v} * __builtin_convertvector(size, F32x4) + 0.5f;  // one more than wanted: >= 0.5
    const I32x4 whole = __builtin_convertvector(at, I32x4);                            // so that this rounds down
    fraction = at - __builtin_convertvector(whole, F32x4);
    first = whole - 1;
    first = first < 0 ? size - 1 : first;
    second = whole >= size ? I32x4{0, 0, 0, 0} : whole;
  }

  // Bilinear in one of the two levels (lane 0 or 2 names its u). Returns: r, g, b, a times their scale.
  F32x4 blend(const Level& level, int lane) const {
    const auto load = [&](std::int32_t column, std::int32_t row) {
      return to_floats(&level.texels[static_cast<std::size_t>(row) * static_cast<std::size_t>(level.width) +
                                     static_cast<std::size_t>(column)]);
    };
    const float x = fraction[lane], y = fraction[lane + 1];
    const F32x4 upper_left = load(first[lane], first[lane + 1]), lower_left = load(first[lane], second[lane + 1]);
    const F32x4 upper = upper_left + x * (load(second[lane], first[lane + 1]) - upper_left);
    const F32x4 lower = lower_left + x * (load(second[lane], second[lane + 1]) - lower_left);
    return upper + y * (lower - upper);
  }
};

// Four points in one level, in one go: their columns and rows side by side, and their texels two at a time.
struct TextureSet::FourLookups {
  struct Axis {
    I32x4 first, second;
    F32x4 fraction;

    // As in Lookup. Requires: 0 <= at <= 1.
    Axis(const F32x4& at, int size) {
      const F32x4 place = at * static_cast<float>(size) + 0.5f;
      const I32x4 whole = __builtin_convertvector(place, I32x4);
      fraction = place - __builtin_convertvector(whole, F32x4);
      first = whole - 1;
      first = first < 0 ? I32x4{} + (size - 1) : first;
      second = whole >= size ? I32x4{} : whole;
    }
  };
  F32x4 u, v;  // within the texture

  explicit FourLookups(const std::array<glm::vec2, 4>& uv) {
    for (int k = 0; k < 4; ++k) u[k] = uv[static_cast<std::size_t>(k)].x - std::floor(uv[static_cast<std::size_t>(k)].x);
    for (int k = 0; k < 4; ++k) v[k] = uv[static_cast<std::size_t>(k)].y - std::floor(uv[static_cast<std::size_t>(k)].y);
  }
  // Returns: r, g, b, a times four times their scale.
  F32x4 sum(const Level& level) const {
    const Axis columns(u, level.width), rows(v, level.height);
    F32x8 total{};
    for (int k = 0; k < 4; ++k) {
      const std::int32_t left = columns.first[k], right = columns.second[k];
      const auto load = [&](std::int32_t row, F32x8& pair) {
        const Texel* first = &level.texels[static_cast<std::size_t>(row) * static_cast<std::size_t>(level.width)];
        if (right == left + 1) return load_pair(first + left, pair);
        const Texel both[2] = {first[left], first[right]};
        load_pair(both, pair);
      };
      F32x8 upper, lower;
      load(rows.first[k], upper), load(rows.second[k], lower);
      const float x = columns.fraction[k], rest = 1 - x;
      total += (upper + rows.fraction[k] * (lower - upper)) * F32x8{rest, rest, rest, rest, x, x, x, x};
    }
    return F32x4{total[0], total[1], total[2], total[3]} + F32x4{total[4], total[5], total[6], total[7]};
  }
};

TextureSet::TextureSet() {
  for (int code = 0; code < 256; ++code) linear_[code] = srgb_to_linear(static_cast<std::uint8_t>(code));
}

std::uint32_t TextureSet::add(const TextureImage& image, const MipOptions& options) {
  Texture texture;
  const std::vector<MipLevel> chain = build_mip_chain(image, options);
  std::array<std::uint16_t, 256> wide;
  for (std::size_t code = 0; code < 256; ++code)
    wide[code] = static_cast<std::uint16_t>(std::lround(linear_[code] * kLinearScale));
  for (const MipLevel& from : chain) {
    Level& level = texture.levels.emplace_back(Level{from.width, from.height, {}});
    level.texels.reserve(from.texels.size());
    for (const std::uint32_t t : from.texels)
      level.texels.push_back(
          {wide[t & 255], wide[t >> 8 & 255], wide[t >> 16 & 255], static_cast<std::uint16_t>((t >> 24) * 257)});
  }
  // Of the first level and its size: the other levels follow from it, but for the cutoff, which scales their alpha.
  const MipLevel& first = chain.front();
  struct Header {
    std::int32_t width, height;
    float alpha_cutoff;
  };
  const Header header{first.width, first.height, options.keeps_alpha ? options.alpha_cutoff : 0.0f};
  texture.hash = hash_values(std::span<const std::uint32_t>(first.texels), hash_value(header));
  if (texture.hash == 0) texture.hash = 1;  // 0 means "no texture"
  texture.texel_count = static_cast<float>(first.texels.size());
  textures_.push_back(std::move(texture));
  return static_cast<std::uint32_t>(textures_.size() - 1);
}

void TextureSet::write(MemoryImageWriter& out) const {
  out.put<std::uint64_t>(textures_.size());
  for (const Texture& texture : textures_) {
    out.put(texture.hash);
    out.put<std::uint64_t>(texture.levels.size());
    for (const Level& level : texture.levels) {
      out.put<std::int32_t>(level.width);
      out.put<std::int32_t>(level.height);
      out.put_array(level.texels);
    }
  }
}

void TextureSet::read(MemoryImageReader& in) {
  constexpr std::size_t kLeastTexture = 16, kLeastLevel = 16;
  textures_.clear();
  for (std::size_t left = in.get_count(kLeastTexture); left > 0 && in.is_valid(); --left) {
    Texture texture;
    texture.hash = in.get<ContentHash>();
    for (std::size_t levels = in.get_count(kLeastLevel); levels > 0 && in.is_valid(); --levels) {
      Level level;
      level.width = in.get<std::int32_t>();
      level.height = in.get<std::int32_t>();
      level.texels = in.get_array<Texel>();
      in.require(level.width > 0 && level.height > 0 && level.width <= kMaxTextureEdge && level.height <= kMaxTextureEdge);
      in.require(level.texels.size() == static_cast<std::uint64_t>(level.width) * static_cast<std::uint64_t>(level.height));
      texture.levels.push_back(std::move(level));
    }
    in.require(!texture.levels.empty());
    if (!in.is_valid()) return;
    texture.texel_count = static_cast<float>(texture.levels.front().texels.size());
    textures_.push_back(std::move(texture));
  }
}

glm::vec3 TextureSet::sample(std::uint32_t texture, const glm::vec2& uv, float mip) const {
  const std::vector<Level>& levels = textures_[texture].levels;
  const std::size_t last = levels.size() - 1;
  mip = std::min(mip, static_cast<float>(last));
  const auto at = static_cast<std::size_t>(mip);
  const Level& fine = levels[at];
  const Level& coarse = levels[std::min(at + 1, last)];
  const Lookup lookup(fine, coarse, uv);
  F32x4 sum = lookup.blend(fine, 0);
  const float towards_coarse = mip - static_cast<float>(at);
  if (towards_coarse > 0.0f) sum += towards_coarse * (lookup.blend(coarse, 2) - sum);
  return glm::vec3(sum[0], sum[1], sum[2]) * (1.0f / kLinearScale);
}

glm::vec3 TextureSet::mean_of_four(std::uint32_t texture, const std::array<glm::vec2, 4>& uv, float mip) const {
  const std::vector<Level>& levels = textures_[texture].levels;
  const std::size_t last = levels.size() - 1;
  mip = std::min(mip, static_cast<float>(last));
  const auto at = static_cast<std::size_t>(mip);
  const FourLookups lookups(uv);
  F32x4 sum = lookups.sum(levels[at]);
  const float towards_coarse = mip - static_cast<float>(at);
  if (towards_coarse > 0.0f) sum += towards_coarse * (lookups.sum(levels[std::min(at + 1, last)]) - sum);
  return glm::vec3(sum[0], sum[1], sum[2]) * (0.25f / kLinearScale);
}

float TextureSet::sample_alpha(std::uint32_t texture, const glm::vec2& uv) const {
  const Level& first = textures_[texture].levels.front();
  return Lookup(first, first, uv).blend(first, 0)[3] * (1.0f / kLinearScale);
}

TextureLevel TextureSet::texture_level(std::uint32_t texture, int level) const {
  const Level& from = textures_[texture].levels[static_cast<std::size_t>(level)];
  TextureLevel out;
  out.texture = textures_[texture].hash;
  out.level = level;
  out.level_count = level_count(texture);
  out.width = from.width;
  out.height = from.height;
  out.rgba.reserve(4 * from.texels.size());
  // Linear values are finer than half a code step everywhere, so this gives the very codes they were made from.
  for (const Texel& t : from.texels) {
    for (const std::uint16_t channel : {t.r, t.g, t.b})
      out.rgba.push_back(linear_to_srgb(static_cast<float>(channel) / kLinearScale));
    out.rgba.push_back(static_cast<std::uint8_t>(t.a / 257));
  }
  return out;
}

}  // namespace farfield
