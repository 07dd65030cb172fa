// SPDX-License-Identifier: Apache-2.0
// Textures of near geometry on the GPU: what has arrived of each, uploaded coarse levels first within a budget per
// frame, evicted by bytes, least recently drawn first. Belongs to the context's thread.
#pragma once

#include <cstdint>
#include <memory>
#include <unordered_map>

#include "client/gl/gl_handle.h"
#include "client/store/leaf_view.h"

namespace farfield::client {

class TextureCache {
 public:
  /// `budget_bytes`: what is drawn in the current frame stays, even beyond it.
  /// `frame_upload_bytes`: soft limit per frame; a texture's first, coarse levels always go through.
  TextureCache(std::size_t budget_bytes, std::size_t frame_upload_bytes, int max_edge);

  void begin_frame();
  /// Returns: the GL texture, complete with the levels uploaded so far; 0 if it holds no usable level.
  GlName use(const DecodedTexture& texture);
  /// Deletes what the budget does not cover.
  void end_frame();

  std::size_t held_bytes() const { return held_bytes_; }
  std::size_t frame_uploaded_bytes() const { return frame_uploaded_bytes_; }

 private:
  struct Entry {
    TextureName texture;
    std::size_t first_level = 0;  // index in DecodedTexture::levels of the coarsest level in use
    std::size_t level_count = 0;  // in use, from there
    std::size_t uploaded = 0;     // of these
    std::size_t bytes = 0;
    std::uint64_t last_frame = 0;
  };
  Entry create(const DecodedTexture& texture) const;
  void upload_some(const DecodedTexture& texture, Entry& entry);

  std::size_t budget_bytes_, frame_upload_bytes_;
  int max_edge_;
  std::size_t held_bytes_ = 0, frame_uploaded_bytes_ = 0;
  std::uint64_t frame_ = 0;
  std::unordered_map<std::uint64_t, Entry> entries_;  // by serial
};

}  // namespace farfield::client
