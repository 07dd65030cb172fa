// SPDX-License-Identifier: Apache-2.0
// The type number in every frame's header: which message of proto/farfield.proto follows.
// Numbers are never reused. Receivers skip types they do not know.
#pragma once

#include <cstdint>

namespace farfield {

enum class MessageType : std::uint16_t {
  kHello = 1,
  kWelcome = 2,
  kFailure = 3,
  kGoAway = 4,
  kBye = 5,
  kPing = 6,
  kPong = 7,

  kPose = 16,
  kEvicted = 17,

  kLeafSet = 32,
  kLeafSetComplete = 33,

  kTilePayload = 48,
  kChunkPayload = 49,
  kTexturePayload = 50,
};

/// Versions of the messages this build speaks: what Hello and Welcome negotiate.
inline constexpr std::uint32_t kProtocolVersionMin = 1;
inline constexpr std::uint32_t kProtocolVersionMax = 1;

}  // namespace farfield
