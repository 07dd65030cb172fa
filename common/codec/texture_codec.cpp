// SPDX-License-Identifier: Apache-2.0
// The encoded texture level, version 2. Little-endian.
//
//   u8  version = 2
//   u8  flags                bit 0 colour is panels (else zstd of R G B rows), 1 an alpha plane follows
//   u64 texture              content hash
//   u8  level, u8 level count
//   u16 width, u16 height    1 … kMaxTextureEdge
//   varint colour bytes, colour
//                            panels: squares of kPanelEdge texels, those of the last column and row perhaps smaller, row by row;
//                            each a varint of its bytes, and as many: colour_codec.h, quality kColourQuality
//   the rest: zstd of the alpha plane, rows top to bottom, only with flag 1; without it all texels are opaque
#include "common/codec/texture_codec.h"

#include <zstd.h>

#include <algorithm>
#include <cassert>

#include "common/codec/colour_codec.h"

namespace farfield {
namespace {

constexpr std::uint8_t kVersion = 2;
constexpr int kColourQuality = 95;
constexpr int kZstdLevel = 3;
constexpr int kLeastCodedEdge = 16;  // the coder has learnt nothing before
constexpr int kPanelEdge = 256;      // bounds what coding takes besides the texels, to some 4 MB

enum Flags : std::uint8_t { kPanels = 1, kAlpha = 2, kKnownFlags = 3 };

/// Calls visit(x, y, width, height) for each panel until it returns false.
template <class Visit>
bool each_panel(const TextureLevel& level, Visit visit) {
  for (int y = 0; y < level.height; y += kPanelEdge)
    for (int x = 0; x < level.width; x += kPanelEdge)
      if (!visit(x, y, std::min(kPanelEdge, level.width - x), std::min(kPanelEdge, level.height - y))) return false;
  return true;
}

/// A tile of that size that is covered all over.
TileBits whole(int width, int height) {
  Tile tile;
  tile.width = width, tile.height = height;
  tile.coverage.assign(tile.samples(), 1);
  tile.cut_right.assign(tile.samples(), kConnected), tile.cut_down = tile.cut_right;
  return TileBits(tile);
}

Bytes encode_panels(const TextureLevel& level) {
  ByteWriter out;
  each_panel(level, [&](int x, int y, int width, int height) {
    Bytes rgb;
    rgb.reserve(std::size_t{3} * static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
    for (int row = y; row < y + height; ++row)
      for (int column = x; column < x + width; ++column) {
        const std::uint8_t* texel = &level.rgba[4 * (static_cast<std::size_t>(row) * level.width + column)];
        rgb.insert(rgb.end(), texel, texel + 3);
      }
    const Bytes panel = encode_colour(rgb, whole(width, height), kColourQuality);
    out.put_varint(panel.size());
    out.put_bytes(panel);
    return true;
  });
  return out.take();
}

/// Returns: false if the bytes end too early or too late.
bool decode_panels(ByteView colour, TextureLevel& level) {
  ByteReader in(colour);
  const bool is_complete = each_panel(level, [&](int x, int y, int width, int height) {
    const std::uint64_t size = in.get_varint();
    if (!in.ok() || size > in.remaining()) return false;
    const std::vector<std::uint8_t> rgb = decode_colour(in.get_bytes(size), whole(width, height), kColourQuality);
    for (int row = 0; row < height; ++row)
      for (int column = 0; column < width; ++column) {
        std::uint8_t* texel = &level.rgba[4 * (static_cast<std::size_t>(y + row) * level.width + x + column)];
        std::copy_n(&rgb[3 * (static_cast<std::size_t>(row) * width + column)], 3, texel);
      }
    return true;
  });
  return is_complete && in.remaining() == 0;
}

Bytes compressed(ByteView bytes) {
  Bytes out(ZSTD_compressBound(bytes.size()));
  const std::size_t size = ZSTD_compress(out.data(), out.size(), bytes.data(), bytes.size(), kZstdLevel);
  assert(!ZSTD_isError(size));
  out.resize(size);
  return out;
}

Bytes plane(const std::vector<std::uint8_t>& rgba, int first_channel, int channels) {
  Bytes out;
  out.reserve(rgba.size() / 4 * static_cast<std::size_t>(channels));
  for (std::size_t i = 0; i < rgba.size(); i += 4)
    for (int c = 0; c < channels; ++c) out.push_back(rgba[i + static_cast<std::size_t>(first_channel + c)]);
  return out;
}

tl::unexpected<Error> bad(const char* what) {
  return fail(ErrorCode::kBadData, "encoded texture level: {}; ask the server for it again", what);
}

}  // namespace

Bytes encode_texture_level(const TextureLevel& level) {
  assert(level.rgba.size() ==
         std::size_t{4} * static_cast<std::size_t>(level.width) * static_cast<std::size_t>(level.height));
  bool is_opaque = true;
  for (std::size_t i = 3; i < level.rgba.size() && is_opaque; i += 4) is_opaque = level.rgba[i] == 255;
  Bytes colour;
  std::uint8_t flags = is_opaque ? 0 : kAlpha;
  if (std::min(level.width, level.height) >= kLeastCodedEdge) {
    flags |= kPanels;
    colour = encode_panels(level);
  } else {
    colour = compressed(plane(level.rgba, 0, 3));
  }

  ByteWriter out;
  out.put(kVersion);
  out.put(flags);
  out.put(level.texture);
  out.put(static_cast<std::uint8_t>(level.level));
  out.put(static_cast<std::uint8_t>(level.level_count));
  out.put(static_cast<std::uint16_t>(level.width));
  out.put(static_cast<std::uint16_t>(level.height));
  out.put_varint(colour.size());
  out.put_bytes(colour);
  if (!is_opaque) out.put_bytes(compressed(plane(level.rgba, 3, 1)));
  return out.take();
}

Result<TextureLevel> decode_texture_level(ByteView bytes) {
  ByteReader in(bytes);
  const auto version = in.get<std::uint8_t>();
  if (in.ok() && version != kVersion)
    return fail(ErrorCode::kVersionMismatch,
                "encoded texture level: version {}, this program reads {}; update the older side", version, kVersion);
  const auto flags = in.get<std::uint8_t>();
  TextureLevel level;
  level.texture = in.get<ContentHash>();
  level.level = in.get<std::uint8_t>();
  level.level_count = in.get<std::uint8_t>();
  level.width = in.get<std::uint16_t>();
  level.height = in.get<std::uint16_t>();
  const std::uint64_t colour_bytes = in.get_varint();
  if (!in.ok() || colour_bytes > in.remaining()) return bad("cut off");
  if (flags & ~kKnownFlags) return bad("unknown flags");
  if (level.level >= level.level_count) return bad("its level is past its level count");
  if (level.width < 1 || level.height < 1) return bad("it has no texels");
  if (std::max(level.width, level.height) > kMaxTextureEdge)
    return fail(ErrorCode::kLimitExceeded, "encoded texture level: {}×{} texels, at most {} along an edge are allowed",
                level.width, level.height, kMaxTextureEdge);
  const ByteView colour = in.get_bytes(colour_bytes);
  const ByteView alpha = in.get_bytes(in.remaining());
  const std::size_t texels = static_cast<std::size_t>(level.width) * static_cast<std::size_t>(level.height);

  if (flags & kPanels) {
    // A panel of nothing but its size would be a byte: what is allocated is bounded by what arrived.
    const auto panels = [](int edge) { return static_cast<std::size_t>((edge + kPanelEdge - 1) / kPanelEdge); };
    if (colour.size() < panels(level.width) * panels(level.height)) return bad("its colour is cut off");
    level.rgba.assign(4 * texels, 255);
    if (!decode_panels(colour, level)) return bad("its colour is cut off");
  } else {
    Bytes rgb(3 * texels);
    if (ZSTD_decompress(rgb.data(), rgb.size(), colour.data(), colour.size()) != rgb.size())
      return bad("its colour is damaged");
    level.rgba.resize(4 * texels);
    for (std::size_t i = 0; i < texels; ++i) {
      for (std::size_t c = 0; c < 3; ++c) level.rgba[4 * i + c] = rgb[3 * i + c];
      level.rgba[4 * i + 3] = 255;
    }
  }
  if (flags & kAlpha) {
    Bytes plane_bytes(texels);
    if (ZSTD_decompress(plane_bytes.data(), texels, alpha.data(), alpha.size()) != texels)
      return bad("its alpha is damaged");
    for (std::size_t i = 0; i < texels; ++i) level.rgba[4 * i + 3] = plane_bytes[i];
  } else if (!alpha.empty()) {
    return bad("bytes follow its end");
  }
  return level;
}

}  // namespace farfield
