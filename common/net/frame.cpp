// SPDX-License-Identifier: Apache-2.0
#include "common/net/frame.h"

namespace farfield {

Result<FrameHead> decode_frame_head(ByteView bytes, const FrameLimits& limits) {
  ByteReader reader(bytes);
  const auto magic = reader.get<std::uint32_t>();
  FrameHead head;
  head.version = reader.get<std::uint16_t>();
  head.type = reader.get<std::uint16_t>();
  head.message_bytes = reader.get<std::uint32_t>();
  head.payload_bytes = reader.get<std::uint32_t>();
  if (!reader.ok() || magic != kFrameMagic) {
    return fail(ErrorCode::kBadData, "these bytes are no Farfield frame (magic {:#010x}): is this the right port?",
                magic);
  }
  if (head.version != kFrameVersion) {
    return fail(ErrorCode::kVersionMismatch, "frame layout version {}, this program reads {}: update the older side",
                head.version, kFrameVersion);
  }
  if (head.message_bytes > limits.message_bytes || head.payload_bytes > limits.payload_bytes) {
    return fail(ErrorCode::kLimitExceeded, "frame of type {} with {} + {} bytes, allowed are {} + {}", head.type,
                head.message_bytes, head.payload_bytes, limits.message_bytes, limits.payload_bytes);
  }
  return head;
}

OutgoingFrame make_frame(MessageType type, ByteView message, SharedBytes payload) {
  ByteWriter writer;
  writer.bytes().reserve(kFrameHeadBytes + message.size());
  writer.put(kFrameMagic);
  writer.put(kFrameVersion);
  writer.put(static_cast<std::uint16_t>(type));
  writer.put(static_cast<std::uint32_t>(message.size()));
  writer.put(static_cast<std::uint32_t>(payload ? payload->size() : 0));
  writer.put_bytes(message);
  OutgoingFrame frame;
  frame.head = writer.take();
  frame.payload = std::move(payload);
  return frame;
}

}  // namespace farfield
