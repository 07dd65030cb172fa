// SPDX-License-Identifier: Apache-2.0
#include "common/net/frame.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "common/net/frame_decoder.h"

namespace farfield {
namespace {

constexpr FrameLimits kLimits{1000, 300000};

Bytes pattern(std::size_t size, std::uint8_t seed) {
  Bytes bytes(size);
  for (std::size_t i = 0; i < size; ++i) bytes[i] = static_cast<std::uint8_t>(seed + i * 7 + (i >> 8));
  return bytes;
}

Bytes on_the_wire(const OutgoingFrame& frame) {
  Bytes bytes = frame.head;
  if (frame.payload) bytes.insert(bytes.end(), frame.payload->begin(), frame.payload->end());
  return bytes;
}

/// Feeds `stream` in pieces of at most `piece` bytes.
Result<std::vector<IncomingFrame>> decode_in_pieces(const Bytes& stream, const std::function<std::size_t()>& piece) {
  FrameDecoder decoder(kLimits);
  std::vector<IncomingFrame> frames;
  for (std::size_t at = 0; at < stream.size();) {
    const std::span<std::uint8_t> target = decoder.writable();
    EXPECT_FALSE(target.empty());
    const std::size_t size = std::min({target.size(), piece(), stream.size() - at});
    std::copy_n(stream.data() + at, size, target.data());
    decoder.commit(size);
    at += size;
    for (;;) {
      auto frame = decoder.next();
      if (!frame) return tl::unexpected(frame.error());
      if (!frame->has_value()) break;
      frames.push_back(std::move(**frame));
    }
  }
  EXPECT_FALSE(decoder.is_within_frame());
  return frames;
}

TEST(Frame, HeadIsSixteenLittleEndianBytes) {
  const OutgoingFrame frame = make_frame(MessageType::kTilePayload, pattern(3, 1), std::make_shared<Bytes>(pattern(5, 2)));
  const Bytes expected{'F', 'A', 'R', 'F', 1, 0, 48, 0, 3, 0, 0, 0, 5, 0, 0, 0, 1, 8, 15};
  EXPECT_EQ(frame.head, expected);
  EXPECT_EQ(frame.size(), 16u + 3 + 5);
}

TEST(Frame, PayloadIsSharedNotCopied) {
  const SharedBytes payload = std::make_shared<Bytes>(pattern(1000, 3));
  const OutgoingFrame frame = make_frame(MessageType::kTilePayload, {}, payload);
  EXPECT_EQ(frame.payload.get(), payload.get());
}

TEST(Frame, StreamsCutAnywhereDecodeToTheSameFrames) {
  std::mt19937 random(7);
  std::vector<std::pair<Bytes, Bytes>> sent;
  Bytes stream;
  for (const std::size_t payload : {0u, 1u, 100u, 65535u, 65536u, 65537u, 200000u, 0u, 300000u, 17u}) {
    const Bytes message = pattern(random() % 900, static_cast<std::uint8_t>(random()));
    const Bytes bytes = pattern(payload, static_cast<std::uint8_t>(random()));
    sent.emplace_back(message, bytes);
    const Bytes wire = on_the_wire(make_frame(MessageType::kTilePayload, message, std::make_shared<Bytes>(bytes)));
    stream.insert(stream.end(), wire.begin(), wire.end());
  }
  for (const std::size_t largest : {1u, 15u, 17u, 4096u, 70000u, 1u << 20}) {
    const auto frames = decode_in_pieces(stream, [&] { return 1 + random() % largest; });
    ASSERT_TRUE(frames) << frames.error().message;
    ASSERT_EQ(frames->size(), sent.size());
    for (std::size_t i = 0; i < sent.size(); ++i) {
      EXPECT_EQ((*frames)[i].message, sent[i].first);
      EXPECT_EQ((*frames)[i].payload ? *(*frames)[i].payload : Bytes(), sent[i].second);
    }
  }
}

TEST(Frame, OversizedFramesAreRefusedBeforeTheyArrive) {
  for (const auto& [message, payload] : {std::pair<std::uint32_t, std::uint32_t>{1001, 0}, {0, 300001}, {0xffffffff, 0xffffffff}}) {
    ByteWriter writer;
    writer.put(kFrameMagic);
    writer.put(kFrameVersion);
    writer.put(std::uint16_t{1});
    writer.put(message);
    writer.put(payload);
    const auto frames = decode_in_pieces(writer.take(), [] { return std::size_t{1000}; });
    ASSERT_FALSE(frames);
    EXPECT_EQ(frames.error().code, ErrorCode::kLimitExceeded);
  }
}

TEST(Frame, GarbageAndOtherVersionsAreNamed) {
  const Bytes http{'G', 'E', 'T', ' ', '/', ' ', 'H', 'T', 'T', 'P', '/', '1', '.', '1', '\r', '\n'};
  const auto garbage = decode_in_pieces(http, [] { return std::size_t{5}; });
  ASSERT_FALSE(garbage);
  EXPECT_EQ(garbage.error().code, ErrorCode::kBadData);

  Bytes future = make_frame(MessageType::kHello, {}).head;
  future[4] = 2;
  const auto version = decode_in_pieces(future, [] { return std::size_t{100}; });
  ASSERT_FALSE(version);
  EXPECT_EQ(version.error().code, ErrorCode::kVersionMismatch);
}

TEST(Frame, RandomBytesNeverYieldMoreThanTheyHold) {
  std::mt19937 random(11);
  for (int round = 0; round < 300; ++round) {
    Bytes stream = on_the_wire(make_frame(MessageType::kPose, pattern(20, 1), std::make_shared<Bytes>(pattern(30, 2))));
    for (int flips = 0; flips < 3; ++flips) stream[random() % stream.size()] = static_cast<std::uint8_t>(random());
    FrameDecoder decoder(kLimits);
    std::copy(stream.begin(), stream.end(), decoder.writable().begin());
    decoder.commit(stream.size());
    std::size_t decoded = 0;
    for (;;) {
      const auto frame = decoder.next();
      if (!frame || !frame->has_value()) break;
      decoded += kFrameHeadBytes + (*frame)->message.size() + ((*frame)->payload ? (*frame)->payload->size() : 0);
    }
    EXPECT_LE(decoded, stream.size());
  }
}

}  // namespace
}  // namespace farfield
