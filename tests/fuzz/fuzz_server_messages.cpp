// SPDX-License-Identifier: Apache-2.0
// What a client believes of a server: the first byte chooses the message, the rest is its bytes.
#include <cmath>

#include "client/session/wire_convert.h"
#include "common/net/message.h"
#include "proto/farfield.pb.h"
#include "tests/fuzz/require.h"

using namespace farfield;
using farfield::fuzz::require;

namespace {

IncomingFrame frame_of(MessageType type, ByteView message) {
  IncomingFrame frame;
  frame.type = static_cast<std::uint16_t>(type);
  frame.message.assign(message.begin(), message.end());
  return frame;
}

void read_welcome(ByteView bytes) {
  const auto welcome = parse_message<wire::Welcome>(frame_of(MessageType::kWelcome, bytes));
  if (!welcome) return;
  const auto scene = client::to_scene_description(welcome->scene());
  if (!scene) return;
  require(scene->frame.grid.finest_side_m > 0, "a scene has cells");
}

void read_leaf_set(ByteView bytes) {
  const auto message = parse_message<wire::LeafSet>(frame_of(MessageType::kLeafSet, bytes));
  if (!message) return;
  const auto set = client::to_leaf_set(*message);
  if (!set) return;
  require(set->leaf.level <= kMaxCellLevel && set->root.level <= kMaxCellLevel, "cells are on the grid");
  for (const auto& chunk : set->chunks) {
    for (int column = 0; column < 4; ++column) {
      for (int row = 0; row < 3; ++row) require(std::isfinite(chunk.cell_from_chunk[column][row]), "places are finite");
    }
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const ByteView bytes(data + 1, size - 1);
  switch (data[0] % 6) {
    case 0: read_welcome(bytes); break;
    case 1: read_leaf_set(bytes); break;
    case 2: (void)parse_message<wire::Failure>(frame_of(MessageType::kFailure, bytes)); break;
    case 3: (void)parse_message<wire::GoAway>(frame_of(MessageType::kGoAway, bytes)); break;
    case 4: (void)parse_message<wire::TexturePayload>(frame_of(MessageType::kTexturePayload, bytes)); break;
    default: (void)parse_message<wire::Pong>(frame_of(MessageType::kPong, bytes)); break;
  }
  return 0;
}
