// SPDX-License-Identifier: Apache-2.0
#include "client/decode/payload_decoder.h"

#include <algorithm>
#include <utility>

#include "common/base/thread_clock.h"
#include "common/codec/texture_codec.h"
#include "common/geometry/chunk.h"

namespace farfield::client {
namespace {

template <class T>
std::size_t heap_bytes(const std::vector<T>& values) {
  return values.capacity() * sizeof(T);
}

std::size_t memory_of(const DecodedTile& tile) {
  return sizeof(DecodedTile) + tile.mesh.memory_bytes() + tile.splats.memory_bytes();
}

std::string context_of(const PayloadName& name) {
  return fmt::format("{} {:016x} from the server", payload_kind_name(name.kind), name.key);
}

bool is_on_grid(const CellId& cell) {
  return cell.level <= kMaxCellLevel && cell.x >= 0 && cell.y >= 0 && cell.z >= 0;
}

Result<DecodedPayload> decode_chunk_payload(const EncodedPayload& payload) {
  Result<Chunk> chunk = decode_chunk(*payload.bytes);
  if (!chunk) return fail_within(context_of(payload.name), std::move(chunk.error()));
  auto decoded = std::make_shared<DecodedChunk>();
  decoded->hash = payload.name.key;
  decoded->serial = next_serial();
  decoded->chunk = std::move(*chunk);
  DecodedPayload result;
  result.name = payload.name;
  result.memory_bytes = sizeof(DecodedChunk) + heap_bytes(decoded->chunk.vertices) + heap_bytes(decoded->chunk.indices);
  result.chunk = std::move(decoded);
  return result;
}

Result<DecodedPayload> decode_texture_payload(const EncodedPayload& payload) {
  Result<TextureLevel> level = decode_texture_level(*payload.bytes);
  if (!level) return fail_within(context_of(payload.name), std::move(level.error()));
  DecodedPayload result;
  result.name = payload.name;
  result.texture_level = std::move(*level);
  // The frame's header names the texture; the bytes may be shared by several.
  result.texture_level.texture = payload.name.texture;
  result.texture_level.level = payload.name.level;
  result.memory_bytes = sizeof(TextureLevel) + result.texture_level.rgba.size();
  return result;
}

}  // namespace

PayloadDecoder::PayloadDecoder(CellGrid grid, DecodeForm form, TileDecoder tile_decoder)
    : grid_(grid), form_(form), tile_decoder_(std::move(tile_decoder)) {}

Result<DecodedPayload> PayloadDecoder::decode_tile_payload(const EncodedPayload& payload) const {
  Result<Tile> tile = tile_decoder_(*payload.bytes);
  if (!tile) return fail_within(context_of(payload.name), std::move(tile.error()));
  if (!is_on_grid(tile->id.cell)) {
    return fail(ErrorCode::kBadData, "{}: its cell lies outside the grid", context_of(payload.name));
  }
  auto decoded = std::make_shared<DecodedTile>();
  decoded->id = tile->id;
  decoded->serial = next_serial();
  decoded->side_m = grid_.side_m(tile->id.cell.level);
  decoded->view_position = grid_.box(tile->id.cell).center() + glm::dvec3(tile->view_offset) * decoded->side_m;
  decoded->tolerance = tile->disparity_tolerance;
  decoded->edge_samples = tile->edge_samples;
  decoded->covered_samples = static_cast<std::uint32_t>(std::count(tile->coverage.begin(), tile->coverage.end(), 1));
  decoded->certificate = tile->certificate;
  if (form_ != DecodeForm::kSplats) decoded->mesh = PackedMesh(build_depth_mesh(*tile, tile->disparity_tolerance));
  if (form_ != DecodeForm::kMesh) decoded->splats = build_splats(*tile);
  decoded->memory_bytes = memory_of(*decoded);
  DecodedPayload result;
  result.name = payload.name;
  result.memory_bytes = decoded->memory_bytes;
  result.tile = std::move(decoded);
  return result;
}

DecodedPayload undecoded(const EncodedPayload& payload) {
  // Counted as what it would take decoded, so that a client that decodes nothing forgets and asks again as one that does.
  constexpr std::size_t kMeanDecodedBytes = 54'000;  // of the payloads of a walk through a plant
  // Nobody looks into them, so one of each will do.
  static const auto kTile = std::make_shared<const DecodedTile>();
  static const auto kChunk = std::make_shared<const DecodedChunk>();
  DecodedPayload result;
  result.name = payload.name;
  result.memory_bytes = kMeanDecodedBytes;
  if (payload.name.kind == PayloadKind::kTile) result.tile = kTile;
  if (payload.name.kind == PayloadKind::kChunk) result.chunk = kChunk;
  if (payload.name.kind == PayloadKind::kTextureLevel) result.texture_level.texture = payload.name.texture, result.texture_level.level = payload.name.level;
  return result;
}

Result<DecodedPayload> PayloadDecoder::decode(const EncodedPayload& payload) const {
  if (form_ == DecodeForm::kNone) return undecoded(payload);
  const double start = thread_seconds();
  Result<DecodedPayload> result = payload.name.kind == PayloadKind::kTile    ? decode_tile_payload(payload)
                                  : payload.name.kind == PayloadKind::kChunk ? decode_chunk_payload(payload)
                                                                             : decode_texture_payload(payload);
  if (result) result->seconds = thread_seconds() - start;
  return result;
}

}  // namespace farfield::client
