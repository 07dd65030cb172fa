// SPDX-License-Identifier: Apache-2.0
// Yes/no decisions whose probability is mixed from what several contexts have learned.
//
// Based on: M. Mahoney, "Adaptive weighing of context models for lossless data compression", 2005 (PAQ): logits of the
// contexts' probabilities, times weights that follow the coding error. A context that has seen nothing yet has logit 0
// and so no say: many fine contexts can be asked in a stream of a kilobyte, where each alone would learn too slowly.
// Integers throughout, and tables made by the compiler: every machine decodes alike.
#pragma once

#include <algorithm>
#include <array>

#include "common/codec/bit_coder.h"

namespace farfield {

/// Logits ln(p / (1 - p)) in steps of 1/256, from -8 to 8 (exclusive).
inline constexpr int kLogitOne = 256, kLogitEnd = 8 * kLogitOne;

namespace detail {
// Probability in 1/65536 of the logit i - kLogitEnd. By multiplication only, which all compilers round alike.
inline constexpr std::array<std::uint16_t, 2 * kLogitEnd> kProbabilities = [] {
  double step = 1, term = 1;  // e^(1/256): eight terms of the series leave less than 1e-20
  for (int n = 1; n <= 8; ++n) step += term /= n * kLogitOne;
  std::array<std::uint16_t, 2 * kLogitEnd> table{};
  double power = 1;
  for (int i = 0; i < kLogitEnd; ++i, power *= step) {
    const auto above = static_cast<int>(65536 * power / (1 + power) + 0.5);
    table[kLogitEnd + i] = static_cast<std::uint16_t>(above);
    table[kLogitEnd - i] = static_cast<std::uint16_t>(65536 - above);
  }
  table[0] = table[1];
  return table;
}();
// The reverse, of probabilities in 1/4096.
inline constexpr std::array<std::int16_t, 4096> kLogits = [] {
  std::array<std::int16_t, 4096> table{};
  int logit = 0;
  for (int p = 0; p < 4096; ++p) {
    while (logit + 1 < 2 * kLogitEnd && kProbabilities[logit] < 16 * p + 8) ++logit;
    table[p] = static_cast<std::int16_t>(logit - kLogitEnd);
  }
  return table;
}();
}  // namespace detail

/// How much each of three contexts is believed, in 1/65536.
struct Mixer {
  std::array<std::int32_t, 3> weights{kFirst, kFirst, kFirst};
  static constexpr std::int32_t kFirst = 65536 / 3, kLargest = 16 * 65536;
};

/// One prediction from three contexts. REQUIRES: contexts and mixer outlive it; update() once, with the bit coded.
/// Spelt out three times: as arrays the compiler takes contexts and logits through vector registers, one by one.
class MixedPrediction {
 public:
  MixedPrediction(BitContext& a, BitContext& b, BitContext& c, Mixer& mixer)
      : a_(a), b_(b), c_(c), mixer_(mixer), logit_a_(logit_of(a)), logit_b_(logit_of(b)), logit_c_(logit_of(c)) {
    const std::int64_t sum = mixer.weights[0] * logit_a_ + mixer.weights[1] * logit_b_ + mixer.weights[2] * logit_c_;
    zero_ = detail::kProbabilities[std::clamp<std::int64_t>(sum >> 16, 1 - kLogitEnd, kLogitEnd - 1) + kLogitEnd];
  }
  /// In 1/65536: 22 at least, so no decision costs more than twelve bits, and none less than 1/2000.
  std::uint32_t zero() const { return static_cast<std::uint32_t>(zero_); }
  void update(bool bit) {
    const std::int64_t error = ((bit ? 0 : 65535) - zero_) * kRate;
    move(mixer_.weights[0], logit_a_ * error >> 20);
    move(mixer_.weights[1], logit_b_ * error >> 20);
    move(mixer_.weights[2], logit_c_ * error >> 20);
    a_.update(bit), b_.update(bit), c_.update(bit);
  }

 private:
  static constexpr std::int64_t kRate = 40;  // streams are short: five times what PAQ uses
  static std::int64_t logit_of(const BitContext& context) { return detail::kLogits[context.zero >> 4]; }
  static void move(std::int32_t& weight, std::int64_t by) {
    weight = static_cast<std::int32_t>(std::clamp<std::int64_t>(weight + by, -Mixer::kLargest, Mixer::kLargest));
  }

  BitContext &a_, &b_, &c_;
  Mixer& mixer_;
  std::int64_t logit_a_, logit_b_, logit_c_, zero_;
};

/// A walk over what is coded serves both directions: it calls code(bit, …) with what to write, and goes on with what comes
/// back. A reader ignores the bit it is given.
class BitWriter {
 public:
  bool code(bool bit, BitContext& context) {
    coder_.put(bit, context);
    return bit;
  }
  bool code(bool bit, MixedPrediction prediction) {
    coder_.put(bit, prediction.zero());
    prediction.update(bit);
    return bit;
  }
  std::int32_t code_integer(std::int32_t value, IntegerContext& context) {
    put_integer(coder_, value, context);
    return value;
  }
  Bytes finish() { return coder_.finish(); }

 private:
  BitEncoder coder_;
};
class BitReader {
 public:
  explicit BitReader(ByteView bytes) : coder_(bytes) {}
  bool code(bool, BitContext& context) { return coder_.get(context); }
  bool code(bool, MixedPrediction prediction) {
    const bool bit = coder_.get(prediction.zero());
    prediction.update(bit);
    return bit;
  }
  std::int32_t code_integer(std::int32_t, IntegerContext& context) { return get_integer(coder_, context); }

 private:
  BitDecoder coder_;
};

/// Three families of contexts for one kind of decision, and mixers to choose from.
template <int kA, int kB, int kC, int kMixers = 1>
class MixedContexts {
 public:
  MixedPrediction operator()(int a, int b, int c, int mixer = 0) { return {a_[a], b_[b], c_[c], mixers_[mixer]}; }

 private:
  std::array<BitContext, kA> a_{};
  std::array<BitContext, kB> b_{};
  std::array<BitContext, kC> c_{};
  std::array<Mixer, kMixers> mixers_{};
};

}  // namespace farfield
