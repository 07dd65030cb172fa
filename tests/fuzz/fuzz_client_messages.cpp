// SPDX-License-Identifier: Apache-2.0
// What a server believes of a client: the first byte chooses the message, the rest is its bytes.
#include <cmath>

#include "common/net/message.h"
#include "proto/farfield.pb.h"
#include "server/session/session_messages.h"
#include "tests/fuzz/require.h"

using namespace farfield;
using farfield::fuzz::require;

namespace {

constexpr CellGrid kGrid{0.5};

void read_pose(const IncomingFrame& frame) {
  const auto message = parse_message<wire::Pose>(frame);
  if (!message) return;
  const auto pose = to_pose(*message, kGrid);
  if (!pose) return;
  for (int axis = 0; axis < 3; ++axis) require(std::isfinite(pose->position[axis]), "positions are finite");
  require(std::abs(glm::length(pose->world_from_camera) - 1.0) < 1e-9, "rotations are unit quaternions");
  const CellId cell = kGrid.cell_at(pose->position, 0);
  require(cell.x >= 0 && cell.y >= 0 && cell.z >= 0, "positions are on the grid");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  IncomingFrame frame;
  frame.message.assign(data + 1, data + size);
  switch (data[0] % 4) {
    case 0: read_pose(frame); break;
    case 1: (void)parse_message<wire::Hello>(frame); break;
    case 2: (void)parse_message<wire::Evicted>(frame); break;
    default: (void)parse_message<wire::Ping>(frame); break;
  }
  return 0;
}
