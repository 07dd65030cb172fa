// SPDX-License-Identifier: Apache-2.0
#include "client/near_cpu/raster_texture.h"

#include <algorithm>
#include <bit>
#include <cmath>
#if defined(__AVX512F__)
#include <immintrin.h>
#endif

#include "client/warp/splat_pixel.h"
#include "common/geometry/chunk.h"
#include "common/shading/shading.h"

namespace farfield::client {
namespace {

constexpr int kVector = 16;
constexpr float kRedSteps = 2047, kBlueSteps = 1023;

std::uint32_t code(const std::uint8_t* rgba) {
  const auto root = [&](int c, float steps) {
    return static_cast<std::uint32_t>(std::lround(steps * std::sqrt(srgb_to_linear(rgba[c]))));
  };
  return root(0, kRedSteps) << 21 | root(1, kRedSteps) << 10 | root(2, kBlueSteps);
}

bool is_well_formed(const TextureLevel& level) {
  return level.width > 0 && level.height > 0 && level.width <= kMaxTextureEdge && level.height <= kMaxTextureEdge &&
         level.rgba.size() == 4 * static_cast<std::size_t>(level.width) * static_cast<std::size_t>(level.height);
}

/// See RasterTexture::texels_.
void append_texels(const TextureLevel& level, std::vector<std::uint32_t>& to) {
  const std::size_t first = to.size(), stride = static_cast<std::size_t>(level.width) + 1;
  to.reserve(first + stride * (static_cast<std::size_t>(level.height) + 1));
  const std::uint8_t* rgba = level.rgba.data();
  for (int row = 0; row < level.height; ++row) {
    for (int column = 0; column < level.width; ++column, rgba += 4) to.push_back(code(rgba));
    to.push_back(to[to.size() - stride + 1]);
  }
  for (std::size_t i = 0; i < stride; ++i) to.push_back(to[first + i]);
}

bool is_half_of(const TextureLevel& coarse, const TextureLevel& fine) {
  return coarse.width == std::max(1, fine.width / 2) && coarse.height == std::max(1, fine.height / 2);
}

/// Binary logarithm of a normal positive number, off by at most 10⁻⁴: a polynomial of the mantissa, Chebyshev-fitted.
inline float logarithm(float value) {
  const auto bits = std::bit_cast<std::uint32_t>(value);
  const float m = std::bit_cast<float>((bits & 0x7fffffu) | 0x3f800000u);
  const float of_mantissa = (((-0.08161236f * m + 0.64511400f) * m - 2.12059498f) * m + 4.06999636f) * m - 2.51281500f;
  return static_cast<float>(static_cast<int>(bits >> 23) - 127) + of_mantissa;
}

inline float floored(float value) {
  const float towards_zero = static_cast<float>(static_cast<int>(value));
  return towards_zero - (towards_zero > value ? 1.0f : 0.0f);
}

/// Where a coordinate lies between two texels of `size` that repeat.
struct Between {
  int first, second;
  float share;
};
/// Of what an int holds: others, as are not numbers, become some place or other, but in range.
inline Between between(float at, int size) {
  const float inside = clamped(at - floored(at), 0.0f, 1.0f), place = inside * static_cast<float>(size) - 0.5f;
  const float below = floored(place);
  const int first = static_cast<int>(below), second = first + 1;
  return {select(mask_of(first < 0), size - 1, first), select(mask_of(second >= size), 0, second), place - below};
}

using Ints = std::array<std::int32_t, kVector>;
using Floats = std::array<float, kVector>;
using Words = std::array<std::uint32_t, kVector>;

/// out[i] = table[at[i]], of sixteen entries.
inline void look_up(const Ints& table, const Ints& at, Ints& out) {
#if defined(__AVX512F__)
  _mm512_store_si512(out.data(), _mm512_maskz_permutexvar_epi32(0xffff, _mm512_load_si512(at.data()), _mm512_load_si512(table.data())));
#else
  for (int i = 0; i < kVector; ++i) out[i] = table[at[i]];
#endif
}

/// The texels at sixteen places and those after them: two at once, gathered words cost as much as pairs of them.
inline void fetch_pairs(const std::uint32_t* texels, const Ints& at, Words& left, Words& right) {
#if defined(__AVX512F__)
  const __m512i places = _mm512_load_si512(at.data());
  const __m512i first = _mm512_mask_i32gather_epi64(_mm512_setzero_si512(), 0xff, _mm512_maskz_extracti64x4_epi64(0xff, places, 0), texels, 4);
  const __m512i second = _mm512_mask_i32gather_epi64(_mm512_setzero_si512(), 0xff, _mm512_maskz_extracti64x4_epi64(0xff, places, 1), texels, 4);
  const __m512i even = _mm512_setr_epi32(0, 2, 4, 6, 8, 10, 12, 14, 16, 18, 20, 22, 24, 26, 28, 30);
  _mm512_store_si512(left.data(), _mm512_permutex2var_epi32(first, even, second));
  _mm512_store_si512(right.data(), _mm512_permutex2var_epi32(first, _mm512_add_epi32(even, _mm512_set1_epi32(1)), second));
#else
  for (int i = 0; i < kVector; ++i) left[i] = texels[at[i]], right[i] = texels[at[i] + 1];
#endif
}

/// Adds a texel's light, in steps, by its weight.
inline void add_light(const Words& texels, const Floats& weight, std::array<Floats, 3>& sum) {
#pragma GCC ivdep  // the arrays do not overlap
  for (int i = 0; i < kVector; ++i) {
    const std::uint32_t texel = texels[i];
    const float red = static_cast<float>(static_cast<int>(texel >> 21)), green = static_cast<float>(static_cast<int>(texel >> 10 & 2047)),
                blue = static_cast<float>(static_cast<int>(texel & 1023));
    sum[0][i] += weight[i] * (red * red), sum[1][i] += weight[i] * (green * green);
    sum[2][i] += weight[i] * (blue * blue);
  }
}

}  // namespace

RasterTexture::RasterTexture(const DecodedTexture& texture) {
  std::size_t end = texture.levels.size();
  while (end > 0 && !is_well_formed(texture.levels[end - 1])) --end;
  const TextureLevel* finer = nullptr;
  for (; end > 0 && level_count_ < kMaxLevels; --end) {  // they come coarsest first
    const TextureLevel& level = texture.levels[end - 1];
    if (!is_well_formed(level) || (finer && !is_half_of(level, *finer))) break;
    const auto k = static_cast<std::size_t>(level_count_++);
    width_[k] = width_[k + 1] = level.width, height_[k] = height_[k + 1] = level.height;
    first_[k] = first_[k + 1] = static_cast<std::int32_t>(texels_.size());
    append_texels(level, texels_);
    finer = &level;
    if (k > 0) continue;
    for (std::size_t at = 3; at < level.rgba.size(); at += 4) alpha_.push_back(level.rgba[at]);
    if (std::all_of(alpha_.begin(), alpha_.end(), [](std::uint8_t a) { return a == 255; })) alpha_.clear();
  }
  texels_.shrink_to_fit(), alpha_.shrink_to_fit();
}

float RasterTexture::alpha_at(float u, float v) const {
  if (alpha_.empty()) return 1;
  const Between x = between(u, width_[0]), y = between(v, height_[0]);
  const auto texel = [&](int column, int row) { return static_cast<float>(alpha_[static_cast<std::size_t>(row * width_[0] + column)]); };
  const float upper = texel(x.first, y.first) * (1 - x.share) + texel(x.second, y.first) * x.share;
  const float lower = texel(x.first, y.second) * (1 - x.share) + texel(x.second, y.second) * x.share;
  return (upper * (1 - y.share) + lower * y.share) * (1.0f / 255);
}

void RasterTexture::multiply(int count, const float* u, const float* v, const float* texel_area, float* const light[3]) const {
  alignas(64) Ints level, here, width, height, first, upper, lower;
  alignas(64) Floats between_levels;
  alignas(64) std::array<Floats, 4> weight;
  alignas(64) Words left, right;
  const float last = static_cast<float>(level_count_ - 1);
  for (int begin = 0; begin < count; begin += kVector) {
    alignas(64) std::array<Floats, 3> sum{};
    int is_mixed = 0;  // some take a share of a coarser level
    for (int i = 0; i < kVector; ++i) between_levels[i] = clamped(texel_area[begin + i], 1.0f, 0x1p30f);
    for (int i = 0; i < kVector; ++i) {
      const float at = clamped(0.5f * logarithm(between_levels[i]), 0.0f, last);
      level[i] = static_cast<int>(at);
      between_levels[i] = at - static_cast<float>(level[i]);
      is_mixed |= mask_of(between_levels[i] > 0);
    }
    for (int coarser = 0; coarser <= (is_mixed != 0 ? 1 : 0); ++coarser) {
      for (int i = 0; i < kVector; ++i) here[i] = level[i] + coarser;
      look_up(width_, here, width), look_up(height_, here, height), look_up(first_, here, first);
#pragma GCC ivdep  // the arrays do not overlap
      for (int i = 0; i < kVector; ++i) {
        const Between x = between(u[begin + i], width[i]), y = between(v[begin + i], height[i]);
        const float share = coarser ? between_levels[i] : 1 - between_levels[i];
        upper[i] = first[i] + y.first * (width[i] + 1) + x.first, lower[i] = upper[i] + width[i] + 1;
        weight[0][i] = share * (1 - y.share) * (1 - x.share), weight[1][i] = share * (1 - y.share) * x.share;
        weight[2][i] = share * y.share * (1 - x.share), weight[3][i] = share * y.share * x.share;
      }
      fetch_pairs(texels_.data(), upper, left, right);
      add_light(left, weight[0], sum), add_light(right, weight[1], sum);
      fetch_pairs(texels_.data(), lower, left, right);
      add_light(left, weight[2], sum), add_light(right, weight[3], sum);
    }
    constexpr float kRed = 1 / (kRedSteps * kRedSteps), kBlue = 1 / (kBlueSteps * kBlueSteps);
    for (int i = 0; i < kVector; ++i) {
      light[0][begin + i] *= sum[0][i] * kRed, light[1][begin + i] *= sum[1][i] * kRed, light[2][begin + i] *= sum[2][i] * kBlue;
    }
  }
}

}  // namespace farfield::client
