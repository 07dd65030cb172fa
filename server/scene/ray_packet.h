// SPDX-License-Identifier: Apache-2.0
// Sixteen rays side by side, and what they hit: the unit of coherent ray casting.
#pragma once

#include <cstdint>
#include <limits>

namespace farfield {

inline constexpr int kPacketSize = 16;
inline constexpr std::uint32_t kNoHit = 0xffffffffu;

/// Layout [component][lane], 64-byte aligned. Scene frame, metres; directions need not be unit length: distances are
/// ray parameters. A lane takes part when its bit in `active` is set and near <= far. A surface at distance 0, through
/// the very origin, is not hit.
struct alignas(64) RayPacket {
  float origin_x[kPacketSize], origin_y[kPacketSize], origin_z[kPacketSize];
  float near[kPacketSize];
  float direction_x[kPacketSize], direction_y[kPacketSize], direction_z[kPacketSize];
  float far[kPacketSize];
  std::uint32_t active = 0xffff;
};

/// Lanes that do not take part hold kNoHit as `part`.
struct alignas(64) HitPacket {
  float distance[kPacketSize];                                            // ray parameter; unchanged `far` on a miss
  float normal_x[kPacketSize], normal_y[kPacketSize], normal_z[kPacketSize];  // geometric, scene frame; length = 2·area
  float u[kPacketSize], v[kPacketSize];                                   // barycentric weights of vertices 1 and 2
  std::uint32_t part[kPacketSize];                                        // Scene part (see scene.h), kNoHit on a miss
  std::uint32_t primitive[kPacketSize];                                   // triangle within the part's mesh
};

}  // namespace farfield
