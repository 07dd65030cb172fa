// SPDX-License-Identifier: Apache-2.0
// Layered depth images to bytes and back. Disparity codes of the front layer are predicted from their neighbours as a
// plane would go on, deeper ones from the one before in the order of their square; residuals as 16-bit words, low and high
// bytes apart, then zstd. Deeper colours fill 8×8 blocks with samples that were neighbours, square by square.
#include <algorithm>
#include <cmath>

#include "tests/bench/baselines/jpeg_image.h"
#include "common/impostor/fill_uncovered.h"
#include "tests/bench/baselines/layered_image.h"
#include "tests/bench/baselines/mesh_panel.h"

namespace farfield::bench {
namespace {

constexpr int kMostLayers = 255;
constexpr int kPackedBlocks = 64;  // side by side in the image of deeper colours

/// How many samples each pixel keeps.
Bytes layer_counts(const LayeredFace& face) {
  Bytes counts(face.pixels());
  for (std::size_t k = 0; k < counts.size(); ++k)
    counts[k] = static_cast<std::uint8_t>(std::min<std::uint32_t>(face.first[k + 1] - face.first[k], kMostLayers));
  return counts;
}

/// Calls visit(pixel, layer) for all samples behind the front: square by square, layer by layer.
template <class Visit>
void for_each_deeper(const Bytes& counts, int edge, Visit visit) {
  const int along = blocks_along(edge);
  for (int by = 0; by < along; ++by)
    for (int bx = 0; bx < along; ++bx) {
      bool any = true;
      for (int layer = 1; any; ++layer) {
        any = false;
        for (int y = by * kImageBlock; y < std::min((by + 1) * kImageBlock, edge); ++y)
          for (int x = bx * kImageBlock; x < std::min((bx + 1) * kImageBlock, edge); ++x) {
            const auto pixel = static_cast<std::size_t>(y) * static_cast<std::size_t>(edge) + static_cast<std::size_t>(x);
            if (counts[pixel] <= layer) continue;
            any = true;
            visit(pixel, static_cast<std::uint32_t>(layer));
          }
      }
    }
}

/// The front layer's code at a pixel as the plane through three coded neighbours continues, or the nearest there is.
int predicted(const std::vector<std::uint16_t>& codes, const Bytes& counts, std::size_t pixel, int edge) {
  const auto width = static_cast<std::size_t>(edge);
  const bool left = pixel % width > 0 && counts[pixel - 1], up = pixel >= width && counts[pixel - width];
  const bool corner = pixel % width > 0 && pixel >= width && counts[pixel - width - 1];
  if (left && up && corner) {
    const int a = codes[pixel - 1], b = codes[pixel - width], c = codes[pixel - width - 1];
    // Where the three are no plane, the nearer of the two neighbours along the smaller step (median edge detector).
    return std::clamp(a + b - c, std::min(a, b), std::max(a, b));
  }
  return left ? codes[pixel - 1] : up ? codes[pixel - width] : 0;
}

std::uint16_t zigzag(int value) { return static_cast<std::uint16_t>(value < 0 ? -2 * value - 1 : 2 * value); }
int unzigzag(std::uint16_t code) { return code & 1 ? -(code + 1) / 2 : code / 2; }

Bytes byte_planes(const std::vector<std::uint16_t>& words) {
  Bytes planes(2 * words.size());
  for (std::size_t k = 0; k < words.size(); ++k) {
    planes[k] = static_cast<std::uint8_t>(words[k]);
    planes[words.size() + k] = static_cast<std::uint8_t>(words[k] >> 8);
  }
  return planes;
}

/// The place of deeper sample `number` in the packed image.
std::size_t packed_pixel(std::size_t number) {
  constexpr std::size_t kPerBlock = kImageBlock * kImageBlock, kWidth = kPackedBlocks * kImageBlock;
  const std::size_t block = number / kPerBlock, within = number % kPerBlock;
  const std::size_t x = block % kPackedBlocks * kImageBlock + within % kImageBlock;
  const std::size_t y = block / kPackedBlocks * kImageBlock + within / kImageBlock;
  return 3 * (y * kWidth + x);
}
int packed_height(std::size_t samples) {
  constexpr std::size_t kPerRow = kImageBlock * kImageBlock * kPackedBlocks;
  return static_cast<int>((samples + kPerRow - 1) / kPerRow) * kImageBlock;
}

Result<Bytes> encode_colours(const LayeredFace& face, const Bytes& counts, int quality) {
  const int edge = face.frame.edge_samples, along = blocks_along(edge);
  std::vector<std::uint8_t> front(3 * counts.size(), 0), covered(counts.size(), 0), deeper;
  std::vector<std::uint8_t> wanted(static_cast<std::size_t>(along) * static_cast<std::size_t>(along), 0);
  for (std::size_t k = 0; k < counts.size(); ++k) {
    if (!counts[k]) continue;
    const LayeredSample& s = face.samples[face.first[k]];
    front[3 * k] = s.r, front[3 * k + 1] = s.g, front[3 * k + 2] = s.b, covered[k] = 1;
    const int x = static_cast<int>(k % static_cast<std::size_t>(edge)), y = static_cast<int>(k / static_cast<std::size_t>(edge));
    wanted[static_cast<std::size_t>(y / kImageBlock * along + x / kImageBlock)] = 1;
  }
  fill_uncovered(front, covered, edge, edge);
  const Result<Bytes> image = encode_image_blocks(front, edge, wanted, quality);
  if (!image) return tl::unexpected(image.error());
  ByteWriter out;
  out.put_varint(image->size());
  out.put_bytes(*image);
  std::size_t count = 0;
  for_each_deeper(counts, edge, [&](std::size_t, std::uint32_t) { ++count; });
  if (count == 0) return out.take();
  deeper.assign(packed_pixel(0) + 3 * static_cast<std::size_t>(kPackedBlocks * kImageBlock) * static_cast<std::size_t>(packed_height(count)), 128);
  std::size_t number = 0;
  for_each_deeper(counts, edge, [&](std::size_t pixel, std::uint32_t layer) {
    const LayeredSample& s = face.samples[face.first[pixel] + layer];
    std::uint8_t* to = &deeper[packed_pixel(number++)];
    to[0] = s.r, to[1] = s.g, to[2] = s.b;
  });
  const Result<Bytes> packed = encode_jpeg(deeper, kPackedBlocks * kImageBlock, packed_height(count), quality);
  if (!packed) return tl::unexpected(packed.error());
  out.put_bytes(*packed);
  return out.take();
}

Status decode_colours(ByteView bytes, const Bytes& counts, int quality, LayeredFace& face) {
  const int edge = face.frame.edge_samples;
  ByteReader in(bytes);
  std::vector<std::uint8_t> front;
  const auto sent = decode_image_blocks(in.get_bytes(in.get_varint()), edge, quality, front);
  if (!sent) return tl::unexpected(sent.error());
  const auto set = [](LayeredSample& s, const std::uint8_t* rgb) { s.r = rgb[0], s.g = rgb[1], s.b = rgb[2]; };
  std::size_t deep = face.samples.size();
  for (std::size_t k = 0; k < counts.size(); ++k) {
    if (!counts[k]) continue;
    set(face.samples[face.first[k]], &front[3 * k]);
    --deep;
  }
  if (deep == 0) return {};
  const auto packed = decode_jpeg(in.get_bytes(in.remaining()), kPackedBlocks * kImageBlock, packed_height(deep), quality);
  if (!packed) return tl::unexpected(packed.error());
  std::size_t number = 0;
  for_each_deeper(counts, edge, [&](std::size_t pixel, std::uint32_t layer) {
    set(face.samples[face.first[pixel] + layer], &(*packed)[packed_pixel(number++)]);
  });
  return {};
}

}  // namespace

Result<EncodedLayers> encode_layers(const LayeredFace& face, const LayeredEncoding& encoding) {
  EncodedLayers result;
  if (face.samples.empty()) return result;
  const Bytes counts = layer_counts(face);
  const auto code_of = [&](const LayeredSample& s) { return static_cast<std::uint16_t>(std::min(65535L, std::lround(s.disparity / encoding.disparity_step))); };
  std::vector<std::uint16_t> residuals, codes(counts.size(), 0);
  for (std::size_t k = 0; k < counts.size(); ++k) {
    if (!counts[k]) continue;
    codes[k] = code_of(face.samples[face.first[k]]);
    residuals.push_back(zigzag(static_cast<std::int16_t>(codes[k] - predicted(codes, counts, k, face.frame.edge_samples))));
  }
  int before = 0;
  for_each_deeper(counts, face.frame.edge_samples, [&](std::size_t pixel, std::uint32_t layer) {
    const int code = code_of(face.samples[face.first[pixel] + layer]);
    residuals.push_back(zigzag(static_cast<std::int16_t>(code - before)));
    before = code;
  });
  ByteWriter out;
  const Bytes packed_counts = compress(counts);
  out.put_varint(packed_counts.size());
  out.put_bytes(packed_counts);
  out.put_bytes(compress(byte_planes(residuals)));
  result.depth = out.take();
  Result<Bytes> colour = encode_colours(face, counts, encoding.jpeg_quality);
  if (!colour) return tl::unexpected(colour.error());
  result.colour = std::move(*colour);
  return result;
}

Result<LayeredFace> decode_layers(const ViewFrame& frame, const EncodedLayers& bytes, const LayeredEncoding& encoding) {
  LayeredFace face{frame, {}, {}};
  const auto pixels = static_cast<std::size_t>(frame.edge_samples) * static_cast<std::size_t>(frame.edge_samples);
  if (bytes.depth.empty()) {
    face.first.assign(pixels + 1, 0);
    return face;
  }
  ByteReader in(bytes.depth);
  const Result<Bytes> counts = decompress(in.get_bytes(in.get_varint()), pixels);
  if (!counts) return tl::unexpected(counts.error());
  if (counts->size() != pixels) return fail(ErrorCode::kBadData, "layered image: counts of {} pixels, not {}", counts->size(), pixels);
  for (const std::uint8_t count : *counts) {
    face.first.push_back(static_cast<std::uint32_t>(face.samples.size()));
    face.samples.resize(face.samples.size() + count);
  }
  face.first.push_back(static_cast<std::uint32_t>(face.samples.size()));
  const std::size_t size = face.samples.size();
  const Result<Bytes> planes = decompress(in.get_bytes(in.remaining()), 2 * size);
  if (!planes) return tl::unexpected(planes.error());
  if (planes->size() != 2 * size) return fail(ErrorCode::kBadData, "layered image: disparities of {} samples, not {}", planes->size() / 2, size);
  std::size_t next = 0;
  const auto residual = [&] {
    const auto word = static_cast<std::uint16_t>((*planes)[next] | (*planes)[size + next] << 8);
    ++next;
    return unzigzag(word);
  };
  std::vector<std::uint16_t> codes(pixels, 0);
  for (std::size_t k = 0; k < pixels; ++k) {
    if (!(*counts)[k]) continue;
    codes[k] = static_cast<std::uint16_t>(predicted(codes, *counts, k, frame.edge_samples) + residual());
    face.samples[face.first[k]].disparity = static_cast<float>(codes[k] * encoding.disparity_step);
  }
  std::uint16_t code = 0;
  for_each_deeper(*counts, frame.edge_samples, [&](std::size_t pixel, std::uint32_t layer) {
    code = static_cast<std::uint16_t>(code + residual());
    face.samples[face.first[pixel] + layer].disparity = static_cast<float>(code * encoding.disparity_step);
  });
  if (Status status = decode_colours(bytes.colour, *counts, encoding.jpeg_quality, face); !status) return tl::unexpected(status.error());
  return face;
}

}  // namespace farfield::bench
