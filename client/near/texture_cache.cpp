// SPDX-License-Identifier: Apache-2.0
#include "client/near/texture_cache.h"

#include <epoxy/gl.h>

#include <algorithm>

namespace farfield::client {
namespace {

/// Levels up to this size are uploaded whatever the frame's budget says.
constexpr std::size_t kAlwaysUploadedBytes = 256 * 256 * 4;

bool is_well_formed(const TextureLevel& level, int max_edge) {
  return level.width > 0 && level.height > 0 && level.width <= max_edge && level.height <= max_edge &&
         level.rgba.size() == 4 * static_cast<std::size_t>(level.width) * static_cast<std::size_t>(level.height);
}

/// OpenGL wants every level to be half the finer one, rounded down, and at least 1.
bool is_half_of(const TextureLevel& coarse, const TextureLevel& fine) {
  return coarse.width == std::max(1, fine.width / 2) && coarse.height == std::max(1, fine.height / 2);
}

}  // namespace

TextureCache::TextureCache(std::size_t budget_bytes, std::size_t frame_upload_bytes, int max_edge)
    : budget_bytes_(budget_bytes), frame_upload_bytes_(frame_upload_bytes), max_edge_(max_edge) {}

void TextureCache::begin_frame() {
  ++frame_;
  frame_uploaded_bytes_ = 0;
}

TextureCache::Entry TextureCache::create(const DecodedTexture& texture) const {
  Entry entry;
  std::size_t end = texture.levels.size();
  while (end > 0 && !is_well_formed(texture.levels[end - 1], max_edge_)) --end;
  if (end == 0) return entry;
  entry.first_level = end - 1;
  while (entry.first_level > 0 && is_well_formed(texture.levels[entry.first_level - 1], max_edge_) &&
         is_half_of(texture.levels[entry.first_level - 1], texture.levels[entry.first_level])) {
    --entry.first_level;
  }
  entry.level_count = end - entry.first_level;
  for (std::size_t i = 0; i < entry.level_count; ++i) entry.bytes += texture.levels[entry.first_level + i].rgba.size();
  entry.texture = TextureName::make();
  const TextureLevel& finest = texture.levels[end - 1];
  glBindTexture(GL_TEXTURE_2D, entry.texture.name());
  glTexStorage2D(GL_TEXTURE_2D, static_cast<GLsizei>(entry.level_count), GL_SRGB8_ALPHA8, finest.width, finest.height);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAX_LEVEL, static_cast<GLint>(entry.level_count) - 1);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_REPEAT);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_REPEAT);
  return entry;
}

void TextureCache::upload_some(const DecodedTexture& texture, Entry& entry) {
  const std::size_t before = entry.uploaded;
  glBindTexture(GL_TEXTURE_2D, entry.texture.name());
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  while (entry.uploaded < entry.level_count) {
    const TextureLevel& level = texture.levels[entry.first_level + entry.uploaded];
    const bool is_small = level.rgba.size() <= kAlwaysUploadedBytes || entry.uploaded == 0;
    if (!is_small && frame_uploaded_bytes_ + level.rgba.size() > frame_upload_bytes_ && frame_uploaded_bytes_ > 0)
      break;
    const auto gl_level = static_cast<GLint>(entry.level_count - 1 - entry.uploaded);
    glTexSubImage2D(GL_TEXTURE_2D, gl_level, 0, 0, level.width, level.height, GL_RGBA, GL_UNSIGNED_BYTE,
                    level.rgba.data());
    frame_uploaded_bytes_ += level.rgba.size();
    ++entry.uploaded;
  }
  if (entry.uploaded != before) {
    // The shader's level 0 is the finest level uploaded so far.
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_BASE_LEVEL, static_cast<GLint>(entry.level_count - entry.uploaded));
  }
}

GlName TextureCache::use(const DecodedTexture& texture) {
  auto found = entries_.find(texture.serial);
  if (found == entries_.end()) {
    found = entries_.emplace(texture.serial, create(texture)).first;
    held_bytes_ += found->second.bytes;
  }
  Entry& entry = found->second;
  entry.last_frame = frame_;
  if (entry.uploaded < entry.level_count) upload_some(texture, entry);
  return entry.texture.name();
}

void TextureCache::end_frame() {
  while (held_bytes_ > budget_bytes_) {
    auto oldest = entries_.end();
    for (auto i = entries_.begin(); i != entries_.end(); ++i) {
      if (i->second.last_frame != frame_ &&
          (oldest == entries_.end() || i->second.last_frame < oldest->second.last_frame))
        oldest = i;
    }
    if (oldest == entries_.end()) return;
    held_bytes_ -= oldest->second.bytes;
    entries_.erase(oldest);
  }
}

}  // namespace farfield::client
