// SPDX-License-Identifier: Apache-2.0
// How the planes of a tile's surfaces are written and read: as one that is known already, shifted or not, or anew.
//
// Both directions keep the same state; which of the ways a surface is coded is the encoder's choice. Units and roundings:
// plane_fit.h and disparity_codec.cpp.
#pragma once

#include <array>
#include <vector>

#include "common/codec/mixed_bits.h"
#include "common/codec/plane_fit.h"

namespace farfield {

/// A plane, and by what way it is coded.
struct PlaneChoice {
  enum class Way { kSame, kShifted, kNew };
  int guess = 0;  // which of the guesses it is coded from
  Way way = Way::kSame;
  Plane plane;
};

/// What a surface's plane may be told from: the plane of the surface it is connected to, or else of others nearby.
struct PlaneGuesses {
  static constexpr int kMost = 6;
  std::array<Plane, kMost> planes;
  int count = 0;
  bool is_connected = false;

  void add(const Plane& plane) {
    for (int i = 0; i < count; ++i)
      if (planes[i] == plane) return;
    if (count < kMost) planes[count++] = plane;
  }
};

inline std::int64_t round_shift(std::int64_t value, int shift) { return (value + (std::int64_t{1} << (shift - 1))) >> shift; }

/// An integer whose size is mixed from three contexts. kA…kC: how many of each there are.
template <int kA, int kB, int kC>
class MixedInteger {
 public:
  /// Returns: a value below 2^24 in magnitude, whatever the bytes.
  template <class Coder>
  std::int32_t code(Coder& coder, std::int32_t value, int a, int b, int c) {
    const std::uint32_t wanted = value < 0 ? 0u - static_cast<std::uint32_t>(value) : static_cast<std::uint32_t>(value);
    const auto wanted_bits = static_cast<int>(std::bit_width(wanted));
    int bits = 0;
    while (bits < kMostBits && coder.code(wanted_bits > bits, bits_(a * kMostBits + bits, b * kMostBits + bits, c * kMostBits + bits, bits > 0))) ++bits;
    if (bits == 0) return 0;
    const bool is_negative = coder.code(value < 0, sign_[a]);
    std::uint32_t magnitude = 1;
    for (int i = bits - 2; i >= 0; --i) {
      BitContext even;  // below the second-highest bit magnitudes are as good as random
      magnitude = magnitude * 2 + coder.code(wanted >> i & 1, i == bits - 2 ? second_[bits] : even);
    }
    return is_negative ? -static_cast<std::int32_t>(magnitude) : static_cast<std::int32_t>(magnitude);
  }

 private:
  static constexpr int kMostBits = 24;
  MixedContexts<kA * kMostBits, kB * kMostBits, kC * kMostBits, 2> bits_;
  std::array<BitContext, kA> sign_{};
  std::array<BitContext, kMostBits + 1> second_{};
};

/// The state of planes alone; where surfaces are, its callers know.
template <class Coder>
class PlaneCoder {
 public:
  explicit PlaneCoder(Coder& coder) : coder_(coder) {}

  /// Planes used last, newest first.
  const std::vector<Plane>& recent() const { return recent_; }

  /// Writes `choice`, or reads it. Returns: the plane.
  Plane code(const SurfaceFrame& frame, const PlaneGuesses& guesses, const PlaneChoice& choice) {
    const int index = code_guess(frame, guesses, choice.guess);
    const Plane guess = guesses.planes[index];
    const int connected = guesses.is_connected, size = frame.size_class(), kind = connected * 6 + size;
    if (coder_.code(choice.way == PlaneChoice::Way::kSame, is_same_(kind, history_ * 2 + connected, index * 6 + size))) {
      history_ = (history_ << 1 | 1) & 7;
      return use(guess, guess);
    }
    history_ = history_ << 1 & 7;
    // The slopes of a single sample are nobody's.
    const bool is_new = size > 0 && !coder_.code(choice.way == PlaneChoice::Way::kShifted, is_shifted_(kind, shifts_ * 2 + connected, index * 6 + size));
    if (size > 0) shifts_ = (shifts_ << 1 | (is_new ? 0 : 1)) & 7;
    Plane plane = guess;
    if (is_new) {
      const int dx = code_slope(choice.plane.gx, guess.gx, frame.columns, 0, connected, 0, plane.gx);
      code_slope(choice.plane.gy, guess.gy, frame.rows, 1, connected, std::min(bits_of(dx), 7), plane.gy);
    }
    const int shift = offset_shift(frame);
    const std::int64_t expected = round_shift(guess.at(frame.x, frame.y), shift), wanted = choice.plane.at(frame.x, frame.y) >> shift;
    const std::int32_t difference = offset_.code(coder_, static_cast<std::int32_t>(wanted - expected), kind * 2 + is_new, last_offset_ * 2 + connected, index * 2 + is_new);
    last_offset_ = std::min(bits_of(difference), 15);
    const std::int64_t value = bounded((expected + difference) * (std::int64_t{1} << shift));
    return use(guess, Plane::through(value, frame.x, frame.y, plane.gx, plane.gy));
  }

  /// Values are multiples of 2^this: of single samples half a step is half the tolerance, of others an eighth.
  static int offset_shift(const SurfaceFrame& frame) { return frame.size_class() == 0 ? kOffsetShift + 2 : kOffsetShift; }
  static std::int64_t bounded(std::int64_t value) { return std::clamp(value, -kLargestUnits, kLargestUnits); }
  static constexpr std::int64_t kLargestUnits = std::int64_t{1} << 40;

 private:
  int code_guess(const SurfaceFrame& frame, const PlaneGuesses& guesses, int wanted) {
    int index = 0;
    while (index + 1 < guesses.count &&
           coder_.code(wanted > index, is_later_(index * 8 + guesses.count, frame.size_class() * 6 + index, last_guess_ * 6 + index)))
      ++index;
    if (guesses.count > 1) last_guess_ = index;
    return index;
  }
  // A slope of an extent of one sample is not coded: it is the guess's. Returns: the difference in steps.
  int code_slope(std::int64_t wanted, std::int64_t guess, int extent, int axis, int connected, int other, std::int64_t& slope) {
    if (extent < 2) return 0;
    const int shift = SurfaceFrame::slope_shift(extent);
    const std::int64_t expected = round_shift(guess, shift);
    const std::int32_t difference =
        slope_.code(coder_, static_cast<std::int32_t>((wanted >> shift) - expected), (axis * 2 + connected) * 8 + shift, (axis * 8 + other) * 2 + connected, last_slope_);
    last_slope_ = std::min(bits_of(difference), 15);
    slope = bounded((expected + difference) * (std::int64_t{1} << shift));
    return difference;
  }
  const Plane& use(const Plane& guess, const Plane& plane) {
    auto at = std::find(recent_.begin(), recent_.end(), guess);
    if (at == recent_.end()) {
      if (recent_.size() == kRemembered) recent_.pop_back();
      recent_.push_back(plane), at = recent_.end() - 1;
    }
    *at = plane;
    std::rotate(recent_.begin(), at, at + 1);
    return recent_.front();
  }

  static int bits_of(std::int32_t value) { return static_cast<int>(std::bit_width(static_cast<unsigned>(std::abs(value)))); }

  static constexpr std::size_t kRemembered = 8;
  Coder& coder_;
  std::vector<Plane> recent_;
  int history_ = 0, shifts_ = 0, last_guess_ = 0, last_offset_ = 0, last_slope_ = 0;
  MixedContexts<12, 16, 36> is_same_, is_shifted_;
  MixedContexts<56, 36, 36> is_later_;
  MixedInteger<24, 32, 12> offset_;
  MixedInteger<32, 32, 16> slope_;
};

}  // namespace farfield
