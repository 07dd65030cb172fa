// SPDX-License-Identifier: Apache-2.0
#include "server/scene/texture_set.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "common/shading/shading.h"

namespace farfield {
namespace {

// The four texels around a point, and how far it lies between them.
struct Bilinear {
  std::uint32_t texel[4];
  float x, y;

  Bilinear(const MipLevel& level, const glm::vec2& uv) {
    const Axis across(uv.x, level.width), down(uv.y, level.height);
    const std::uint32_t* upper = level.texels.data() + static_cast<std::size_t>(down.first) * static_cast<std::size_t>(level.width);
    const std::uint32_t* lower = level.texels.data() + static_cast<std::size_t>(down.second) * static_cast<std::size_t>(level.width);
    texel[0] = upper[across.first];
    texel[1] = upper[across.second];
    texel[2] = lower[across.first];
    texel[3] = lower[across.second];
    x = across.fraction;
    y = down.fraction;
  }

 private:
  struct Axis {
    int first, second;
    float fraction;
    Axis(float coordinate, int size) {
      const float at = (coordinate - std::floor(coordinate)) * static_cast<float>(size) - 0.5f;  // -0.5 … size - 0.5
      const float whole = std::floor(at);
      fraction = at - whole;
      first = static_cast<int>(whole);
      second = first + 1;
      if (first < 0) first = size - 1;
      if (second >= size) second = 0;
    }
  };
};

}  // namespace

TextureSet::TextureSet() {
  for (int code = 0; code < 256; ++code) linear_[code] = srgb_to_linear(static_cast<std::uint8_t>(code));
}

std::uint32_t TextureSet::add(const TextureImage& image, const MipOptions& options) {
  Texture texture;
  texture.levels = build_mip_chain(image, options);
  // Of the first level and its size: the other levels follow from it, but for the cutoff, which scales their alpha.
  const MipLevel& first = texture.levels.front();
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

glm::vec3 TextureSet::sample_level(const MipLevel& level, const glm::vec2& uv) const {
  const Bilinear at(level, uv);
  const float w3 = at.x * at.y, w2 = at.y - w3, w1 = at.x - w3, w0 = 1.0f - at.x - w2;
  const float weight[4] = {w0, w1, w2, w3};
  glm::vec3 sum{0};
  for (int i = 0; i < 4; ++i) {
    const std::uint32_t t = at.texel[i];
    sum += weight[i] * glm::vec3(linear_[t & 255], linear_[t >> 8 & 255], linear_[t >> 16 & 255]);
  }
  return sum;
}

glm::vec3 TextureSet::sample(std::uint32_t texture, const glm::vec2& uv, float mip) const {
  const std::vector<MipLevel>& levels = textures_[texture].levels;
  const int last = static_cast<int>(levels.size()) - 1;
  mip = std::min(mip, static_cast<float>(last));
  const int level = static_cast<int>(mip);
  const glm::vec3 fine = sample_level(levels[static_cast<std::size_t>(level)], uv);
  const float fraction = mip - static_cast<float>(level);
  if (level == last || !(fraction > 0.0f)) return fine;
  return fine + fraction * (sample_level(levels[static_cast<std::size_t>(level) + 1], uv) - fine);
}

float TextureSet::sample_alpha(std::uint32_t texture, const glm::vec2& uv) const {
  const Bilinear at(textures_[texture].levels.front(), uv);
  const float upper = static_cast<float>(at.texel[0] >> 24) * (1.0f - at.x) + static_cast<float>(at.texel[1] >> 24) * at.x;
  const float lower = static_cast<float>(at.texel[2] >> 24) * (1.0f - at.x) + static_cast<float>(at.texel[3] >> 24) * at.x;
  return (upper + at.y * (lower - upper)) * (1.0f / 255.0f);
}

TextureLevel TextureSet::texture_level(std::uint32_t texture, int level) const {
  const MipLevel& from = textures_[texture].levels[static_cast<std::size_t>(level)];
  TextureLevel out;
  out.texture = textures_[texture].hash;
  out.level = level;
  out.level_count = level_count(texture);
  out.width = from.width;
  out.height = from.height;
  out.rgba.resize(4 * from.texels.size());
  std::memcpy(out.rgba.data(), from.texels.data(), out.rgba.size());
  return out;
}

}  // namespace farfield
