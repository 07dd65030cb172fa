// SPDX-License-Identifier: Apache-2.0
#include "common/codec/tile_codec.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "common/codec/colour_codec.h"
#include "common/codec/coverage_codec.h"
#include "common/codec/disparity_codec.h"
#include "common/codec/surface_colours.h"
#include "common/impostor/tile_neighbours.h"
#include "common/math/cube_face.h"

namespace farfield {
namespace {

constexpr std::uint16_t kMagic = 0x5446;  // "FT"
constexpr std::uint8_t kVersion = 4;
constexpr std::size_t kCertificatePlace = 39, kCertificateBytes = 15;  // in the header, of which it is the end
constexpr std::size_t kMaxBlocks = std::size_t{kRegionBlocks} * kRegionBlocks;

bool is_possible_tolerance(float tolerance) { return tolerance > 1e-12f && tolerance < 1e3f; }

// Measurements travel with about two digits, never better than they are: a code is a step of 2^(1/steps) upwards from `unit`,
// rounded up, 0 stands for 0 and the largest for "not measured" and for what lies beyond.
struct MeasureScale {
  float unit, steps;
  int largest;
};
constexpr MeasureScale kColourScale{1.0f / 64, 11.0f, 255};     // to 1e5 in steps of 6.5 %: 255² is the most there is
constexpr MeasureScale kDisparityScale{1e-9f, 1024.0f, 65535};  // as exact as a tile's tolerance

std::uint16_t to_code(float value, const MeasureScale& scale) {
  if (!(value >= 0)) return static_cast<std::uint16_t>(scale.largest);
  if (value <= 0) return 0;
  // A value that is a code's comes back as this code: rounding must not lift it by another step.
  constexpr float kRounding = 1e-2f;
  const float step = std::ceil(scale.steps * std::log2(value / scale.unit) - kRounding);
  return static_cast<std::uint16_t>(std::clamp(step + 1, 1.0f, static_cast<float>(scale.largest)));
}
float from_code(std::uint16_t code, const MeasureScale& scale) {
  if (code == scale.largest) return -1.0f;
  return code == 0 ? 0.0f : scale.unit * std::exp2((static_cast<float>(code) - 1) / scale.steps);
}

void put_certificate(ByteWriter& out, const Certificate& c) {
  for (const std::uint16_t count : {c.void_rays, c.void_hits, c.void_worst_rays, c.void_worst_hits}) out.put(count);
  for (int k = 0; k < 2; ++k) {
    out.put(static_cast<std::uint8_t>(to_code(c.colour_mse[k], kColourScale)));
    out.put(static_cast<std::uint8_t>(to_code(c.colour_mse_error[k], kColourScale)));
  }
  out.put(to_code(c.disparity_p99, kDisparityScale));
  out.put(static_cast<std::uint8_t>((c.missed_void ? 1 : 0) | (c.missed_colour ? 2 : 0)));
}

Status get_certificate(ByteReader& in, Certificate& c) {
  for (std::uint16_t* count : {&c.void_rays, &c.void_hits, &c.void_worst_rays, &c.void_worst_hits}) *count = in.get<std::uint16_t>();
  for (int k = 0; k < 2; ++k) {
    c.colour_mse[k] = from_code(in.get<std::uint8_t>(), kColourScale);
    c.colour_mse_error[k] = from_code(in.get<std::uint8_t>(), kColourScale);
  }
  c.disparity_p99 = from_code(in.get<std::uint16_t>(), kDisparityScale);
  const int missed = in.get<std::uint8_t>();
  c.missed_void = missed & 1, c.missed_colour = missed & 2;
  if (c.void_hits > c.void_rays || c.void_worst_hits > c.void_worst_rays) return fail(ErrorCode::kBadData, "tile: an impossible certificate");
  return {};
}

void put_header(ByteWriter& out, const Tile& tile, int quality) {
  out.put(kMagic);
  out.put(kVersion);
  out.put(static_cast<std::uint8_t>(quality));
  out.put(tile.id.cell.level);
  out.put(tile.id.cell.x), out.put(tile.id.cell.y), out.put(tile.id.cell.z);
  out.put(tile.id.view), out.put(tile.id.face), out.put(tile.id.x), out.put(tile.id.y);
  out.put(static_cast<std::uint16_t>(tile.edge_samples));
  for (int a = 0; a < 3; ++a) out.put(tile.view_offset[a]);
  out.put(tile.disparity_tolerance);
  put_certificate(out, tile.certificate);
}

// Blocks are sorted by column, then row: gaps in that order are small and positive.
void put_blocks(ByteWriter& out, const Tile& tile) {
  out.put_varint(tile.blocks.size());
  int previous = -1;
  for (const BlockPlace& b : tile.blocks) {
    const int place = b.x % kRegionBlocks * kRegionBlocks + b.y % kRegionBlocks;
    out.put_varint(static_cast<std::uint64_t>(place - previous - 1));
    previous = place;
  }
}

Status get_blocks(ByteReader& in, Tile& tile) {
  const std::uint64_t count = in.get_varint();
  if (count == 0 || count > kMaxBlocks) return fail(ErrorCode::kBadData, "tile: {} packed blocks, at most {} fit", count, kMaxBlocks);
  std::int64_t place = -1;
  for (std::uint64_t i = 0; i < count; ++i) {
    const std::uint64_t gap = in.get_varint();
    if (!in.ok() || gap >= kMaxBlocks) return fail(ErrorCode::kBadData, "tile: the list of packed blocks is damaged");
    place += static_cast<std::int64_t>(gap) + 1;
    if (place >= static_cast<std::int64_t>(kMaxBlocks)) return fail(ErrorCode::kBadData, "tile: a packed block lies outside its region");
    tile.blocks.push_back({static_cast<std::uint16_t>(tile.id.x * kRegionBlocks + place / kRegionBlocks),
                           static_cast<std::uint16_t>(tile.id.y * kRegionBlocks + place % kRegionBlocks)});
  }
  tile.width = packed_width(count);
  tile.height = packed_height(count);
  return {};
}

Status get_header(ByteReader& in, Tile& tile, int& quality, const TileLimits& limits) {
  if (in.get<std::uint16_t>() != kMagic) return fail(ErrorCode::kBadData, "tile: these bytes are not a tile");
  const int version = in.get<std::uint8_t>();
  if (version != kVersion) return fail(ErrorCode::kVersionMismatch, "tile: format version {}, this program reads {}", version, int{kVersion});
  quality = in.get<std::uint8_t>();
  tile.id.cell.level = in.get<std::uint8_t>();
  tile.id.cell.x = in.get<std::int32_t>(), tile.id.cell.y = in.get<std::int32_t>(), tile.id.cell.z = in.get<std::int32_t>();
  tile.id.view = in.get<std::uint8_t>(), tile.id.face = in.get<std::uint8_t>();
  tile.id.x = in.get<std::uint8_t>(), tile.id.y = in.get<std::uint8_t>();
  tile.edge_samples = in.get<std::uint16_t>();
  for (int a = 0; a < 3; ++a) tile.view_offset[a] = in.get<float>();
  tile.disparity_tolerance = in.get<float>();
  if (Status status = get_certificate(in, tile.certificate); !status) return status;
  if (!in.ok()) return fail(ErrorCode::kBadData, "tile: cut off in its header");
  if (quality < 1 || quality > 100) return fail(ErrorCode::kBadData, "tile: colour quality {} is not in 1…100", quality);
  if (tile.id.cell.level > kMaxCellLevel || tile.id.face >= kCubeFaces) return fail(ErrorCode::kBadData, "tile: no such cell or face");
  if (tile.edge_samples < 4 || tile.edge_samples > limits.edge_samples)
    return fail(ErrorCode::kLimitExceeded, "tile: a face of {} samples, at most {} are accepted", tile.edge_samples, limits.edge_samples);
  const glm::vec3 offset = glm::abs(tile.view_offset);
  // A view stands in its cell, so half a side from the centre at most (one float step of slack is far below 0.51).
  if (!(offset.x <= 0.51f && offset.y <= 0.51f && offset.z <= 0.51f)) return fail(ErrorCode::kBadData, "tile: its view lies outside its cell");
  if (!is_possible_tolerance(tile.disparity_tolerance)) return fail(ErrorCode::kBadData, "tile: impossible disparity tolerance");
  return {};
}

// The header apart from cell and certificate, and everything after it.
ContentHash content_of(const Tile& tile, int quality, ByteView after_header) {
  ByteWriter place;
  place.put(tile.id.view), place.put(tile.id.face), place.put(tile.id.x), place.put(tile.id.y);
  place.put(static_cast<std::uint16_t>(tile.edge_samples)), place.put(static_cast<std::uint8_t>(quality));
  for (int a = 0; a < 3; ++a) place.put(tile.view_offset[a]);
  place.put(tile.disparity_tolerance);
  return hash_bytes(after_header, hash_bytes(place.take()));
}

// The tolerance that can be kept: kMostTolerances.
Result<float> kept_tolerance(const Tile& tile) {
  float largest = 0;
  bool is_usable = true;
  for (std::size_t i = 0; i < tile.samples(); ++i) {
    if (!tile.coverage[i]) continue;
    const float disparity = tile.disparity[i];
    is_usable &= disparity >= 0;  // not NaN either
    largest = disparity > largest ? disparity : largest;
  }
  if (!is_usable || !std::isfinite(largest)) return fail(ErrorCode::kInvalidArgument, "tile: a disparity is negative or not finite");
  const float kept = std::max(tile.disparity_tolerance, largest / kMostTolerances);
  if (!is_possible_tolerance(tile.disparity_tolerance) || !is_possible_tolerance(kept))
    return fail(ErrorCode::kInvalidArgument, "tile: impossible disparity tolerance {} for disparities up to {}", tile.disparity_tolerance, largest);
  return kept;
}

}  // namespace

Result<Bytes> encode_tile(const Tile& tile, const TileEncoding& encoding, TileBytes* accounting, CodedSamples* decoded) {
  const Result<float> tolerance = kept_tolerance(tile);
  if (!tolerance) return tl::unexpected(tolerance.error());
  if (*tolerance > tile.disparity_tolerance) {
    Tile coarser = tile;
    coarser.disparity_tolerance = *tolerance;
    return encode_tile(coarser, encoding, accounting, decoded);
  }
  ByteWriter out;
  put_header(out, tile, encoding.colour_quality);
  const std::size_t header = out.size();
  if (tile.is_packed()) put_blocks(out, tile);
  const TileBits bits(tile);
  Bytes topology = encode_topology(tile, bits);
  Bytes disparity = encode_disparity(tile, bits, decoded ? &decoded->disparity : nullptr);
  std::vector<std::uint8_t> rgb = tile.rgb;
  const Surfaces surfaces = find_surfaces(tile, bits);
  const Bytes bases = take_out_base_colours(surfaces, rgb);
  const Bytes colour = encode_colour(rgb, bits, encoding.colour_quality, decoded ? &decoded->rgb : nullptr);
  if (decoded) put_back_base_colours(bases, surfaces, decoded->rgb);
  const std::uint32_t covered = static_cast<std::uint32_t>(std::count(tile.coverage.begin(), tile.coverage.end(), 1));
  out.put_varint(covered);
  for (const Bytes* part : std::initializer_list<const Bytes*>{&topology, &disparity, &bases, &colour}) out.put_varint(part->size());
  const std::size_t other = out.size();
  for (const Bytes* part : std::initializer_list<const Bytes*>{&topology, &disparity, &bases, &colour}) out.put_bytes(*part);
  if (accounting) {
    *accounting = {static_cast<std::uint32_t>(bases.size() + colour.size()), static_cast<std::uint32_t>(disparity.size()),
                   static_cast<std::uint32_t>(topology.size()), static_cast<std::uint32_t>(other), covered};
  }
  Bytes bytes = out.take();
  if (accounting) accounting->content = content_of(tile, encoding.colour_quality, ByteView(bytes).subspan(header));
  return bytes;
}

Result<Tile> decode_tile(ByteView bytes, const TileLimits& limits) {
  if (bytes.size() > limits.encoded_bytes)
    return fail(ErrorCode::kLimitExceeded, "tile: {} bytes, at most {} are accepted", bytes.size(), limits.encoded_bytes);
  ByteReader in(bytes);
  Tile tile;
  int quality = 0;
  if (Status status = get_header(in, tile, quality, limits); !status) return tl::unexpected(status.error());
  if (tile.is_packed()) {
    if (Status status = get_blocks(in, tile); !status) return tl::unexpected(status.error());
  } else {
    tile.width = tile.height = kTileSamples;
    const int tiles = face_tiles(tile.edge_samples);
    if (tile.id.x >= tiles || tile.id.y >= tiles) return fail(ErrorCode::kBadData, "tile: it lies outside its face");
  }
  in.get_varint();  // covered samples: for accounting
  const std::uint64_t topology_size = in.get_varint(), disparity_size = in.get_varint(), bases_size = in.get_varint(),
                      colour_size = in.get_varint();
  const ByteView topology = in.get_bytes(topology_size), disparity = in.get_bytes(disparity_size), bases = in.get_bytes(bases_size),
                 colour = in.get_bytes(colour_size);
  if (!in.ok() || in.remaining() != 0) return fail(ErrorCode::kBadData, "tile: its parts do not add up to its size");
  decode_topology(topology, tile);
  const TileBits bits(tile);
  tile.rgb = decode_colour(colour, bits, quality);
  put_back_base_colours(bases, find_surfaces(tile, bits), tile.rgb);
  decode_disparity(disparity, bits, tile);
  return tile;
}

void set_certificate(Bytes& encoded, const Certificate& certificate) {
  assert(encoded.size() >= kCertificatePlace + kCertificateBytes);
  ByteWriter out;
  put_certificate(out, certificate);
  const Bytes bytes = out.take();
  assert(bytes.size() == kCertificateBytes);
  std::copy(bytes.begin(), bytes.end(), encoded.begin() + kCertificatePlace);
}

Result<TileBytes> inspect_tile(ByteView bytes) {
  ByteReader in(bytes);
  Tile tile;
  int quality = 0;
  if (Status status = get_header(in, tile, quality, {}); !status) return tl::unexpected(status.error());
  if (tile.is_packed())
    if (Status status = get_blocks(in, tile); !status) return tl::unexpected(status.error());
  TileBytes result;
  result.covered_samples = static_cast<std::uint32_t>(in.get_varint());
  result.topology = static_cast<std::uint32_t>(in.get_varint());
  result.disparity = static_cast<std::uint32_t>(in.get_varint());
  result.colour = static_cast<std::uint32_t>(in.get_varint());  // the bases
  result.colour += static_cast<std::uint32_t>(in.get_varint());
  if (!in.ok()) return fail(ErrorCode::kBadData, "tile: cut off in its header");
  result.other = static_cast<std::uint32_t>(bytes.size() - in.remaining());
  return result;
}

}  // namespace farfield
