// SPDX-License-Identifier: Apache-2.0
// H.264 as a game stream uses it: every picture goes in and comes out at once, coded from the one before. Through
// libavcodec; x264 encodes. BT.709, limited range.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "common/base/bytes.h"
#include "common/base/result.h"

namespace farfield::bench {

struct VideoSettings {
  int width = 0, height = 0;  // even
  double pictures_per_second = 30;
  double crf = 23;               // x264's constant rate factor: 0 … 51, more is worse
  double kbit_s = 0;             // if positive: an average rate instead, kept over one second
  bool has_full_chroma = false;  // 4:4:4 instead of 4:2:0
};

/// x264, preset superfast, tuned for no delay: no pictures held back, none coded from later ones. Only the first picture
/// stands alone: over TCP nothing is lost, so nothing ever needs to begin again.
class VideoEncoder {
 public:
  /// Errors: kUnavailable (libavcodec without x264), kInvalidArgument (odd sizes).
  static Result<VideoEncoder> create(const VideoSettings& settings);
  VideoEncoder(VideoEncoder&&) noexcept;
  ~VideoEncoder();
  /// sRGB rows top to bottom, 3·width·height bytes. Returns: the coded picture. Errors: kInternal.
  Result<Bytes> encode(std::span<const std::uint8_t> rgb);

 private:
  struct State;
  explicit VideoEncoder(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

class VideoDecoder {
 public:
  /// Errors: kUnavailable.
  static Result<VideoDecoder> create();
  VideoDecoder(VideoDecoder&&) noexcept;
  ~VideoDecoder();
  /// Returns: sRGB rows top to bottom. Pictures must come in the encoder's order. Errors: kBadData.
  Result<std::vector<std::uint8_t>> decode(const Bytes& picture);

 private:
  struct State;
  explicit VideoDecoder(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace farfield::bench
