// SPDX-License-Identifier: Apache-2.0
// Tiles from anywhere on their whole way through the client: decoded, then made into splats and a depth mesh.
#include <memory>

#include "client/decode/payload_decoder.h"
#include "common/codec/tile_codec.h"
#include "tests/fuzz/require.h"

using namespace farfield;
using farfield::fuzz::require;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const client::PayloadDecoder decoder(CellGrid{0.5}, client::DecodeForm::kBoth,
                                       [](ByteView bytes) { return decode_tile(bytes); });
  client::EncodedPayload payload;
  payload.name = {client::PayloadKind::kTile, 1};
  payload.bytes = std::make_shared<const Bytes>(data, data + size);
  const auto decoded = decoder.decode(payload);
  require(decoded.has_value() || !decoded.error().message.empty(), "every error says what is wrong");
  return 0;
}
