// SPDX-License-Identifier: Apache-2.0
// An image as the blocks of it that are needed, packed side by side and coded as one JPEG.
#include <zstd.h>

#include <algorithm>

#include "tests/bench/baselines/jpeg_image.h"
#include "tests/bench/baselines/mesh_panel.h"

namespace farfield::bench {
namespace {

constexpr int kZstdLevel = 15;

/// Calls visit(block x, block y, packed x, packed y) for each wanted block; returns how many there are. Blocks keep their
/// column count, so that an image of which all is wanted is packed as it stands.
template <class Visit>
int for_each_packed(std::span<const std::uint8_t> wanted, int along, Visit visit) {
  int packed = 0;
  for (int y = 0; y < along; ++y)
    for (int x = 0; x < along; ++x) {
      if (!wanted[static_cast<std::size_t>(y * along + x)]) continue;
      visit(x, y, packed % along, packed / along);
      ++packed;
    }
  return packed;
}

std::size_t pixel(int width, int x, int y) { return 3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)); }

}  // namespace

Bytes compress(ByteView bytes) {
  ByteWriter out;
  out.put_varint(bytes.size());
  const std::size_t head = out.size();
  out.bytes().resize(head + ZSTD_compressBound(bytes.size()));
  out.bytes().resize(head + ZSTD_compress(out.bytes().data() + head, out.bytes().size() - head, bytes.data(), bytes.size(), kZstdLevel));
  return out.take();
}

Result<Bytes> decompress(ByteView bytes, std::size_t limit) {
  ByteReader in(bytes);
  const std::uint64_t size = in.get_varint();
  if (!in.ok() || size > limit) return fail(ErrorCode::kBadData, "baseline payload: {} bytes of {} allowed", size, limit);
  Bytes out(size);
  const ByteView packed = in.get_bytes(in.remaining());
  if (ZSTD_decompress(out.data(), out.size(), packed.data(), packed.size()) != size)
    return fail(ErrorCode::kBadData, "baseline payload: not what was compressed");
  return out;
}

Result<Bytes> encode_image_blocks(std::span<const std::uint8_t> rgb, int edge, std::span<const std::uint8_t> wanted, int quality) {
  const int along = blocks_along(edge), width = along * kImageBlock;
  const Bytes all(static_cast<std::size_t>(along) * static_cast<std::size_t>(along), 1);
  if (wanted.empty()) wanted = all;
  const int count = for_each_packed(wanted, along, [](int, int, int, int) {});
  const int height = (count + along - 1) / along * kImageBlock;
  Bytes packed(pixel(width, 0, height), 128);
  for_each_packed(wanted, along, [&](int bx, int by, int px, int py) {
    for (int y = 0; y < kImageBlock; ++y)
      for (int x = 0; x < kImageBlock; ++x) {
        const std::size_t from = pixel(edge, std::min(bx * kImageBlock + x, edge - 1), std::min(by * kImageBlock + y, edge - 1));
        std::copy_n(&rgb[from], 3, &packed[pixel(width, px * kImageBlock + x, py * kImageBlock + y)]);
      }
  });
  ByteWriter out;
  const Bytes list = compress(ByteView(wanted.data(), wanted.size()));
  out.put_varint(list.size());
  out.put_bytes(list);
  if (count > 0) {
    const Result<Bytes> jpeg = encode_jpeg(packed, width, height, quality);
    if (!jpeg) return tl::unexpected(jpeg.error());
    out.put_bytes(*jpeg);
  }
  return out.take();
}

Result<std::vector<std::uint8_t>> decode_image_blocks(ByteView bytes, int edge, int quality, std::vector<std::uint8_t>& rgb) {
  const int along = blocks_along(edge), width = along * kImageBlock;
  const auto blocks = static_cast<std::size_t>(along) * static_cast<std::size_t>(along);
  ByteReader in(bytes);
  const ByteView list = in.get_bytes(in.get_varint());
  const Result<Bytes> wanted = decompress(list, blocks);
  if (!wanted) return tl::unexpected(wanted.error());
  if (!in.ok() || wanted->size() != blocks) return fail(ErrorCode::kBadData, "baseline image: its list of blocks does not fit");
  rgb.assign(pixel(edge, 0, edge), 128);
  std::vector<std::uint8_t> sent(static_cast<std::size_t>(edge) * static_cast<std::size_t>(edge), 0);
  const int count = for_each_packed(*wanted, along, [](int, int, int, int) {});
  if (count == 0) return sent;
  const Result<std::vector<std::uint8_t>> packed =
      decode_jpeg(in.get_bytes(in.remaining()), width, (count + along - 1) / along * kImageBlock, quality);
  if (!packed) return tl::unexpected(packed.error());
  for_each_packed(*wanted, along, [&](int bx, int by, int px, int py) {
    for (int y = by * kImageBlock; y < std::min((by + 1) * kImageBlock, edge); ++y)
      for (int x = bx * kImageBlock; x < std::min((bx + 1) * kImageBlock, edge); ++x) {
        const std::size_t from = pixel(width, px * kImageBlock + x % kImageBlock, py * kImageBlock + y % kImageBlock);
        std::copy_n(&(*packed)[from], 3, &rgb[pixel(edge, x, y)]);
        sent[pixel(edge, x, y) / 3] = 1;
      }
  });
  return sent;
}

}  // namespace farfield::bench
