// SPDX-License-Identifier: Apache-2.0
#include "client/decode/payload_decoder.h"

#include <gtest/gtest.h>

#include "common/codec/texture_codec.h"
#include "common/codec/tile_codec.h"

namespace farfield::client {
namespace {

constexpr CellGrid kGrid{0.5};

/// A dense intra tile of a wall that fills the tile, three levels up from the finest cell.
Tile wall_tile(const CellId& cell) {
  Tile tile;
  tile.id = {cell, kIntraView, 2, 0, 0};
  tile.edge_samples = face_samples(2);
  tile.view_offset = {0.25f, 0.0f, -0.125f};
  tile.width = tile.height = kTileSamples;
  tile.coverage.assign(tile.samples(), 1);
  tile.disparity.assign(tile.samples(), 0.2f);
  tile.rgb.assign(3 * tile.samples(), 90);
  tile.cut_right.assign(tile.samples(), kConnected);
  tile.cut_down.assign(tile.samples(), kConnected);
  tile.disparity_tolerance = 1e-4f;
  return tile;
}

EncodedPayload payload_of(PayloadKind kind, Bytes bytes) {
  return {{kind, 0xabcdef, 0, 0}, std::make_shared<const Bytes>(std::move(bytes))};
}

PayloadDecoder decoder_giving(Tile tile, DecodeForm form) {
  return {kGrid, form, [tile](ByteView) -> Result<Tile> { return tile; }};
}

TEST(PayloadDecoder, PutsTheViewWhereTheTileSays) {
  const CellId cell = kGrid.cell_at({10, 2, -7}, 3);
  const auto result = decoder_giving(wall_tile(cell), DecodeForm::kSplats).decode(payload_of(PayloadKind::kTile, {1}));
  ASSERT_TRUE(result) << result.error().message;
  const double side = 4.0;  // 0.5 m · 2³
  EXPECT_DOUBLE_EQ(result->tile->side_m, side);
  const glm::dvec3 expected = kGrid.box(cell).center() + side * glm::dvec3(0.25, 0, -0.125);
  EXPECT_LT(glm::distance(result->tile->view_position, expected), 1e-12);
}

TEST(PayloadDecoder, MakesOnlyTheFormAskedFor) {
  const CellId cell = kGrid.cell_at({0, 0, 0}, 0);
  const auto decode = [&](DecodeForm form) {
    return decoder_giving(wall_tile(cell), form).decode(payload_of(PayloadKind::kTile, {1}))->tile;
  };
  EXPECT_EQ(decode(DecodeForm::kMesh)->splats.size(), 0u);
  EXPECT_FALSE(decode(DecodeForm::kMesh)->mesh.is_empty());
  EXPECT_GT(decode(DecodeForm::kSplats)->splats.size(), 0u);
  EXPECT_TRUE(decode(DecodeForm::kSplats)->mesh.is_empty());
  const auto both = decode(DecodeForm::kBoth);
  EXPECT_GT(both->splats.size(), 0u);
  EXPECT_FALSE(both->mesh.is_empty());
  EXPECT_GT(both->memory_bytes, decode(DecodeForm::kMesh)->memory_bytes);
}

TEST(PayloadDecoder, SerialsNeverRepeat) {
  const auto decoder = decoder_giving(wall_tile(kGrid.cell_at({0, 0, 0}, 0)), DecodeForm::kMesh);
  const auto first = decoder.decode(payload_of(PayloadKind::kTile, {1}));
  const auto second = decoder.decode(payload_of(PayloadKind::kTile, {1}));
  EXPECT_NE(first->tile->serial, second->tile->serial);
}

TEST(PayloadDecoder, TakesWhatTheCodecEncodes) {
  const CellId cell = kGrid.cell_at({1, 1, 1}, 1);
  const auto bytes = encode_tile(wall_tile(cell), TileEncoding{});
  ASSERT_TRUE(bytes) << bytes.error().message;
  const PayloadDecoder decoder(kGrid, DecodeForm::kBoth, [](ByteView view) { return decode_tile(view); });
  const auto result = decoder.decode(payload_of(PayloadKind::kTile, *bytes));
  ASSERT_TRUE(result) << result.error().message;
  EXPECT_EQ(result->tile->id.cell, cell);
  EXPECT_NEAR(result->tile->splats.disparity.front(), 0.2f, 1.01e-4f);
}

TEST(PayloadDecoder, BadBytesOfEveryKindAreOneLineThatNamesThePayload) {
  const PayloadDecoder decoder(kGrid, DecodeForm::kBoth, [](ByteView view) { return decode_tile(view); });
  for (const PayloadKind kind : {PayloadKind::kTile, PayloadKind::kChunk, PayloadKind::kTextureLevel}) {
    for (const Bytes& bytes : {Bytes{}, Bytes{1, 2, 3}, Bytes(500, 0xff)}) {
      const auto result = decoder.decode(payload_of(kind, bytes));
      ASSERT_FALSE(result) << payload_kind_name(kind);
      EXPECT_NE(result.error().message.find("0000000000abcdef"), std::string::npos) << result.error().message;
      EXPECT_EQ(result.error().message.find('\n'), std::string::npos);
    }
  }
}

TEST(PayloadDecoder, RefusesTilesOfCellsOutsideTheGrid) {
  Tile tile = wall_tile(kGrid.cell_at({0, 0, 0}, 0));
  tile.id.cell.level = kMaxCellLevel + 1;
  EXPECT_EQ(decoder_giving(tile, DecodeForm::kMesh).decode(payload_of(PayloadKind::kTile, {1})).error().code,
            ErrorCode::kBadData);
  tile.id.cell = {0, -1, 0, 0};
  EXPECT_EQ(decoder_giving(tile, DecodeForm::kMesh).decode(payload_of(PayloadKind::kTile, {1})).error().code,
            ErrorCode::kBadData);
}

TEST(PayloadDecoder, ChunksAndTexturesCarryTheirNames) {
  Chunk chunk;
  chunk.vertices.resize(3);
  for (int i = 0; i < 3; ++i) {
    chunk.vertices[i].position = {static_cast<float>(i == 1), static_cast<float>(i == 2), 0};
    chunk.vertices[i].normal = encode_normal({0, 0, 1});
    chunk.vertices[i].uv = {0, 0};
    chunk.vertices[i].colour = {10, 20, 30, 255};
  }
  chunk.indices = {0, 1, 2};
  const PayloadDecoder decoder(kGrid, DecodeForm::kBoth, [](ByteView view) { return decode_tile(view); });
  const auto decoded = decoder.decode(payload_of(PayloadKind::kChunk, encode_chunk(chunk)));
  ASSERT_TRUE(decoded) << decoded.error().message;
  EXPECT_EQ(decoded->chunk->hash, 0xabcdefu);
  EXPECT_EQ(decoded->chunk->chunk.indices.size(), 3u);

  TextureLevel level{7, 2, 4, 4, 4, Bytes(64, 200)};
  EncodedPayload payload = payload_of(PayloadKind::kTextureLevel, encode_texture_level(level));
  payload.name.texture = 7;
  payload.name.level = 2;
  const auto texture = decoder.decode(payload);
  ASSERT_TRUE(texture) << texture.error().message;
  EXPECT_EQ(texture->texture_level.texture, 7u);
  EXPECT_EQ(texture->texture_level.level, 2);
  EXPECT_GE(texture->memory_bytes, 64u);
}

}  // namespace
}  // namespace farfield::client
