// SPDX-License-Identifier: Apache-2.0
// The byte stream of a connection, cut anywhere: the first byte says in what pieces the rest arrives. Whatever the
// pieces, the same frames must come out.
#include <algorithm>
#include <optional>
#include <vector>

#include "common/net/frame_decoder.h"
#include "tests/fuzz/require.h"

using namespace farfield;
using farfield::fuzz::require;

namespace {

constexpr FrameLimits kLimits{std::size_t{16} << 10, std::size_t{64} << 10};

struct Outcome {
  std::vector<IncomingFrame> frames;
  std::optional<ErrorCode> error;
};

Outcome decode(ByteView stream, std::size_t piece) {
  FrameDecoder decoder(kLimits);
  Outcome outcome;
  for (std::size_t at = 0; at < stream.size();) {
    const std::span<std::uint8_t> target = decoder.writable();
    require(!target.empty(), "there is room as long as next() is called");
    const std::size_t size = std::min({target.size(), piece, stream.size() - at});
    std::copy_n(stream.data() + at, size, target.data());
    decoder.commit(size);
    at += size;
    for (;;) {
      auto frame = decoder.next();
      if (!frame) {
        outcome.error = frame.error().code;
        return outcome;
      }
      if (!*frame) break;
      outcome.frames.push_back(std::move(**frame));
    }
  }
  return outcome;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const ByteView stream(data + 1, size - 1);
  const Outcome whole = decode(stream, stream.size() + 1);
  const Outcome pieces = decode(stream, 1 + data[0]);
  require(whole.error == pieces.error, "the same error however the bytes arrive");
  require(whole.frames.size() == pieces.frames.size(), "the same frames however the bytes arrive");
  for (std::size_t i = 0; i < whole.frames.size(); ++i) {
    const IncomingFrame &a = whole.frames[i], &b = pieces.frames[i];
    require(a.type == b.type && a.message == b.message, "the same messages however the bytes arrive");
    require(!a.payload == !b.payload && (!a.payload || *a.payload == *b.payload), "the same payloads");
    require(a.message.size() <= kLimits.message_bytes && (!a.payload || a.payload->size() <= kLimits.payload_bytes),
            "frames are within the limits");
  }
  return 0;
}
