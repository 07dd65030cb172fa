// SPDX-License-Identifier: Apache-2.0
// Frames: how messages stand in the byte stream. Layout, little-endian:
//
//   offset  0   u32  magic 'FARF' (the bytes F, A, R, F)
//           4   u16  version of this layout, 1
//           6   u16  message type (common/net/message_type.h)
//           8   u32  header_length: bytes of the Protobuf message that follows
//          12   u32  payload_length: raw bytes after it
//          16   …    message, then payload
//
// An outgoing payload is shared with the store and with every other connection that sends it: it is written from
// where it lies, never copied. An incoming frame is bounded by limits before anything is allocated for it.
#pragma once

#include <cstddef>
#include <cstdint>

#include "common/base/bytes.h"
#include "common/base/result.h"
#include "common/net/message_type.h"

namespace farfield {

inline constexpr std::uint32_t kFrameMagic = 0x46524146;  // "FARF" in memory order
inline constexpr std::uint16_t kFrameVersion = 1;
inline constexpr std::size_t kFrameHeadBytes = 16;

/// The largest frame a receiver accepts.
struct FrameLimits {
  std::size_t message_bytes = 0;
  std::size_t payload_bytes = 0;
  std::size_t frame_bytes() const { return kFrameHeadBytes + message_bytes + payload_bytes; }
};
/// What a server accepts of its clients: the largest message is a Hello with every hash it may list.
inline constexpr FrameLimits kFromClientLimits{std::size_t{1} << 20, std::size_t{64} << 10};
/// What a client accepts of its server, unless Welcome announces less.
inline constexpr FrameLimits kFromServerLimits{std::size_t{8} << 20, std::size_t{32} << 20};

/// The fixed part, decoded.
struct FrameHead {
  std::uint16_t version = kFrameVersion;
  std::uint16_t type = 0;
  std::uint32_t message_bytes = 0;
  std::uint32_t payload_bytes = 0;
};

/// Errors: kBadData (wrong magic), kVersionMismatch, kLimitExceeded. Requires: bytes.size() >= kFrameHeadBytes.
Result<FrameHead> decode_frame_head(ByteView bytes, const FrameLimits& limits);

/// A frame on its way out: `head` holds the fixed header and the encoded message; `payload` may be null.
struct OutgoingFrame {
  Bytes head;
  SharedBytes payload;
  std::uint64_t tag = 0;  // the sender's own mark, never sent: names what a discarded frame held

  std::size_t size() const { return head.size() + (payload ? payload->size() : 0); }
};

OutgoingFrame make_frame(MessageType type, ByteView message, SharedBytes payload = nullptr);

/// A frame as it arrived. `type` may be one this build does not know: skip it then.
struct IncomingFrame {
  std::uint16_t type = 0;
  Bytes message;
  SharedBytes payload;  // null when the frame has none

  bool is(MessageType wanted) const { return type == static_cast<std::uint16_t>(wanted); }
};

}  // namespace farfield
