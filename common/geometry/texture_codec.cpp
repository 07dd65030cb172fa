// SPDX-License-Identifier: Apache-2.0
// The encoded texture level, version 1. Little-endian.
//
//   u8  version = 1
//   u8  flags                bit 0 colour is a JPEG (else zstd of R G B rows), 1 an alpha plane follows
//   u64 texture              content hash
//   u8  level, u8 level count
//   u16 width, u16 height    1 … kMaxTextureEdge
//   varint colour bytes, colour
//   the rest: zstd of the alpha plane, rows top to bottom, only with flag 1; without it all texels are opaque
#include <zstd.h>

#include <algorithm>
#include <cassert>

#include "common/geometry/chunk.h"
#include "common/geometry/texture_jpeg.h"

namespace farfield {
namespace {

constexpr std::uint8_t kVersion = 1;
constexpr int kJpegQuality = 90;
constexpr int kZstdLevel = 3;
constexpr int kLeastJpegEdge = 16;  // below, a JPEG's header outweighs its picture

enum Flags : std::uint8_t { kJpeg = 1, kAlpha = 2, kKnownFlags = 3 };

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
  if (std::min(level.width, level.height) >= kLeastJpegEdge) {
    colour = encode_texture_jpeg(level.rgba, level.width, level.height, kJpegQuality);
    if (!colour.empty()) flags |= kJpeg;
  }
  if (!(flags & kJpeg)) colour = compressed(plane(level.rgba, 0, 3));

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

  if (flags & kJpeg) {
    if (Status decoded = decode_texture_jpeg(colour, level.width, level.height, level.rgba); !decoded)
      return fail_within("encoded texture level", std::move(decoded).error());
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
