// SPDX-License-Identifier: Apache-2.0
// From a stream of bytes, cut anywhere, to frames. No I/O: whoever reads the socket fills writable() and calls next().
//
// Small frames are parsed out of one fixed buffer, many per read. The payload of a large frame is read straight into
// its final place. Memory: the buffer plus at most one frame within the limits. Not thread-safe.
#pragma once

#include <array>
#include <optional>
#include <span>

#include "common/net/frame.h"

namespace farfield {

class FrameDecoder {
 public:
  explicit FrameDecoder(const FrameLimits& limits);

  /// Where the next bytes go; never empty as long as next() is called until it returns nothing.
  std::span<std::uint8_t> writable();
  /// Requires: `size` bytes of writable() were filled.
  void commit(std::size_t size);
  /// The next whole frame, or nothing if more bytes are needed. After an error the stream cannot be continued.
  /// Errors: as decode_frame_head().
  Result<std::optional<IncomingFrame>> next();
  /// True inside a frame: the end of the stream here means it was cut.
  bool is_within_frame() const { return head_.has_value() || begin_ != end_; }
  void set_limits(const FrameLimits& limits) { limits_ = limits; }

 private:
  static constexpr std::size_t kBufferBytes = std::size_t{64} << 10;

  std::size_t wanted() const;
  void drain_buffer();

  FrameLimits limits_;
  Bytes buffer_;
  std::size_t begin_ = 0, end_ = 0;  // unread bytes of buffer_
  std::optional<FrameHead> head_;    // of the frame being filled
  Bytes message_, payload_;
  std::size_t filled_ = 0;           // bytes of message, then payload, that have arrived
};

}  // namespace farfield
