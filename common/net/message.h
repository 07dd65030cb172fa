// SPDX-License-Identifier: Apache-2.0
// Between Protobuf messages and frames. Include it where messages are handled, not in public headers.
#pragma once

#include <google/protobuf/message_lite.h>

#include <utility>

#include "common/net/frame.h"

namespace farfield {

/// `message` as a frame, with an optional raw payload behind it.
inline OutgoingFrame make_message(MessageType type, const google::protobuf::MessageLite& message,
                                  SharedBytes payload = nullptr) {
  Bytes encoded(message.ByteSizeLong());
  message.SerializeWithCachedSizesToArray(encoded.data());
  return make_frame(type, encoded, std::move(payload));
}

/// Protobuf prints complaints of its own about bytes from the network (text that is not UTF-8, say) to stderr, as many
/// as a peer likes. From now on it prints nothing in this process; parse_message()'s error says it all. Thread-safe.
void keep_protobuf_quiet();

/// Unknown fields are kept out of the way, as Protobuf does. Errors: kBadData.
template <class Message>
Result<Message> parse_message(const IncomingFrame& frame) {
  keep_protobuf_quiet();
  Message message;
  if (!message.ParseFromArray(frame.message.data(), static_cast<int>(frame.message.size()))) {
    return fail(ErrorCode::kBadData, "a frame of type {} with {} bytes holds no {}", frame.type, frame.message.size(),
                message.GetTypeName());
  }
  return message;
}

}  // namespace farfield
