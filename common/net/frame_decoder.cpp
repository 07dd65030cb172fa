// SPDX-License-Identifier: Apache-2.0
#include "common/net/frame_decoder.h"

#include <algorithm>
#include <utility>

namespace farfield {

FrameDecoder::FrameDecoder(const FrameLimits& limits) : limits_(limits), buffer_(kBufferBytes) {}

std::size_t FrameDecoder::wanted() const { return message_.size() + payload_.size() - filled_; }

std::span<std::uint8_t> FrameDecoder::writable() {
  // A payload that still wants more than a buffer full is read where it will stay.
  if (head_ && begin_ == end_ && filled_ >= message_.size() && wanted() >= kBufferBytes) {
    return std::span(payload_).subspan(filled_ - message_.size());
  }
  if (begin_ == end_) begin_ = end_ = 0;
  if (end_ == buffer_.size() && begin_ > 0) {
    std::copy(buffer_.begin() + static_cast<std::ptrdiff_t>(begin_), buffer_.end(), buffer_.begin());
    end_ -= std::exchange(begin_, 0);
  }
  return std::span(buffer_).subspan(end_);
}

void FrameDecoder::commit(std::size_t size) {
  if (head_ && begin_ == end_ && filled_ >= message_.size() && wanted() >= kBufferBytes) {
    filled_ += size;
  } else {
    end_ += size;
  }
}

void FrameDecoder::drain_buffer() {
  const auto move_into = [&](Bytes& target, std::size_t at) {
    const std::size_t size = std::min(end_ - begin_, target.size() - at);
    std::copy_n(buffer_.data() + begin_, size, target.data() + at);
    begin_ += size;
    filled_ += size;
  };
  if (filled_ < message_.size()) move_into(message_, filled_);
  if (filled_ >= message_.size() && wanted() > 0) move_into(payload_, filled_ - message_.size());
}

Result<std::optional<IncomingFrame>> FrameDecoder::next() {
  if (!head_) {
    if (end_ - begin_ < kFrameHeadBytes) return std::nullopt;
    const Result<FrameHead> head =
        decode_frame_head(ByteView(buffer_).subspan(begin_, kFrameHeadBytes), limits_);
    if (!head) return tl::unexpected(head.error());
    begin_ += kFrameHeadBytes;
    head_ = *head;
    message_.assign(head->message_bytes, 0);
    payload_.assign(head->payload_bytes, 0);
    filled_ = 0;
  }
  drain_buffer();
  if (wanted() > 0) return std::nullopt;
  IncomingFrame frame;
  frame.type = head_->type;
  frame.message = std::exchange(message_, {});
  if (!payload_.empty()) frame.payload = std::make_shared<const Bytes>(std::exchange(payload_, {}));
  head_.reset();
  filled_ = 0;
  return std::optional<IncomingFrame>(std::move(frame));
}

}  // namespace farfield
