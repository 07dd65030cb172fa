// SPDX-License-Identifier: Apache-2.0
// Adaptive binary range coding: each yes/no decision is coded with the probability learned in its context.
//
// Based on: G. N. N. Martin, "Range encoding", 1979, in the carry-propagating byte form known from LZMA.
// Tiles are a few kilobytes: too little for a dictionary coder to learn anything, enough for adaptive contexts.
// Reading past the end yields zeros for ever, so decoders stay bounded by the number of symbols they ask for.
#pragma once

#include <array>
#include <bit>
#include <cstdint>

#include "common/base/bytes.h"

namespace farfield {

/// Probability of a zero bit in 1/65536. The n-th symbol of a context moves it by about 1/(n + 1.5) of the error, as
/// counting would, until 1/32 is reached: streams are short, and what a context learns first is worth the most.
struct BitContext {
  std::uint16_t zero = 32768;
  std::uint8_t seen = 0;

  void update(bool bit) {
    const std::uint32_t error = bit ? zero - std::uint32_t{kLeast} : 65536 - std::uint32_t{kLeast} - zero;
    const auto step = static_cast<std::int32_t>(error * std::uint64_t{kReciprocals[seen]} >> 31);
    zero = static_cast<std::uint16_t>(bit ? zero - step : zero + step);
    seen = static_cast<std::uint8_t>(seen + (seen < kSlowest));
  }
  static constexpr int kSlowest = 31;
  static constexpr std::int32_t kLeast = 64;  // no symbol ever costs more than ten bits, none less than 1/700

  // 1/(2·seen + 3) in steps of 1/2^32, rounded up: quotients of anything below 2^25 are exact.
  static constexpr std::array<std::uint32_t, kSlowest + 1> kReciprocals = [] {
    std::array<std::uint32_t, kSlowest + 1> table{};
    for (std::uint32_t seen = 0; seen <= kSlowest; ++seen)
      table[seen] = static_cast<std::uint32_t>(((std::uint64_t{1} << 32) + 2 * seen + 2) / (2 * seen + 3));
    return table;
  }();
};

class BitEncoder {
 public:
  void put(bool bit, BitContext& context) {
    put(bit, std::uint32_t{context.zero});
    context.update(bit);
  }
  /// `zero`: probability of a zero bit in 1/65536, neither 0 nor all.
  void put(bool bit, std::uint32_t zero) {
    const std::uint32_t bound = (range_ >> 16) * zero;
    low_ += bit ? bound : 0;
    range_ = bit ? range_ - bound : bound;
    while (range_ < (1u << 24)) {
      range_ <<= 8;
      shift_low();
    }
  }
  Bytes finish() {
    for (int i = 0; i < 5; ++i) shift_low();
    // The decoder reads zeros past the end, so trailing zeros need not be stored.
    while (!bytes_.empty() && bytes_.back() == 0) bytes_.pop_back();
    return std::move(bytes_);
  }

 private:
  void shift_low() {
    if (low_ < 0xff000000ull || low_ > 0xffffffffull) {
      const auto carry = static_cast<std::uint8_t>(low_ >> 32);
      if (has_cache_) bytes_.push_back(static_cast<std::uint8_t>(cache_ + carry));
      for (; pending_ > 0; --pending_) bytes_.push_back(static_cast<std::uint8_t>(0xff + carry));
      cache_ = static_cast<std::uint8_t>(low_ >> 24);
      has_cache_ = true;
    } else {
      ++pending_;
    }
    low_ = (low_ & 0x00ffffffull) << 8;
  }

  std::uint64_t low_ = 0;
  std::uint32_t range_ = 0xffffffffu;
  std::uint8_t cache_ = 0;
  bool has_cache_ = false;
  std::uint64_t pending_ = 0;
  Bytes bytes_;
};

class BitDecoder {
 public:
  explicit BitDecoder(ByteView bytes) : bytes_(bytes) {
    for (int i = 0; i < 4; ++i) code_ = (code_ << 8) | next();
  }
  bool get(BitContext& context) {
    const bool bit = get(std::uint32_t{context.zero});
    context.update(bit);
    return bit;
  }
  bool get(std::uint32_t zero) {
    const std::uint32_t bound = (range_ >> 16) * zero;
    const bool bit = code_ >= bound;
    if (!bit) {
      range_ = bound;
    } else {
      code_ -= bound;
      range_ -= bound;
    }
    while (range_ < (1u << 24)) {
      range_ <<= 8;
      code_ = (code_ << 8) | next();
    }
    return bit;
  }

 private:
  std::uint8_t next() { return at_ < bytes_.size() ? bytes_[at_++] : 0; }

  ByteView bytes_;
  std::size_t at_ = 0;
  std::uint32_t range_ = 0xffffffffu;
  std::uint32_t code_ = 0;
};

/// Contexts of one adaptive Exp-Golomb integer: small magnitudes of a skewed distribution become fractions of a bit.
struct IntegerContext {
  BitContext zero, sign, length[24], mantissa[24];
};

inline void put_integer(BitEncoder& coder, std::int32_t value, IntegerContext& context) {
  coder.put(value != 0, context.zero);
  if (value == 0) return;
  coder.put(value < 0, context.sign);
  const std::uint32_t magnitude = value < 0 ? 0u - static_cast<std::uint32_t>(value) : static_cast<std::uint32_t>(value);
  const int bits = std::bit_width(magnitude) - 1;
  for (int i = 0; i < 23; ++i) {
    coder.put(i < bits, context.length[i]);
    if (i >= bits) break;
  }
  BitContext even;  // below the second-highest bit magnitudes are as good as random
  for (int i = bits - 1; i >= 0; --i) {
    const bool bit = (magnitude >> i) & 1;
    if (i == bits - 1) {
      coder.put(bit, context.mantissa[bits]);
    } else {
      even = {};
      coder.put(bit, even);
    }
  }
}

/// Returns: a value below 2^24 in magnitude, whatever the bytes.
inline std::int32_t get_integer(BitDecoder& coder, IntegerContext& context) {
  if (!coder.get(context.zero)) return 0;
  const bool is_negative = coder.get(context.sign);
  int bits = 0;
  while (bits < 23 && coder.get(context.length[bits])) ++bits;
  std::uint32_t magnitude = 1;
  BitContext even;
  for (int i = bits - 1; i >= 0; --i) {
    if (i == bits - 1) {
      magnitude = magnitude * 2 + coder.get(context.mantissa[bits]);
    } else {
      even = {};
      magnitude = magnitude * 2 + coder.get(even);
    }
  }
  return is_negative ? -static_cast<std::int32_t>(magnitude) : static_cast<std::int32_t>(magnitude);
}

}  // namespace farfield
